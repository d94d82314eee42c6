#include "many_strokes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "brushsvg/checkpoint.hpp"
#include "brushsvg/error.hpp"
#include "brushsvg/lag_arc.hpp"
#include "brushsvg/plan.hpp"
#include "quiet_row.hpp"

namespace brushsvg {
namespace {

using Eigen::Index;

/// An arc turns by less than a whole turn.
constexpr double kMostTurn = 6.28;
/// Depths may be rounded by so much.
constexpr double kRounded = 1e-9;

void refuse_row(const ManyWays& ways, const std::vector<LagLaw<double>>& lags, Eigen::Index i);

/// Number i of a row of `lanes`, or the only one.
Index lane_of(const Lanes& numbers, Index lane) { return numbers.cols() == 1 ? 0 : lane; }

class Follower {
 public:
    Follower(const ManyWays& ways, const std::vector<LagLaw<double>>& lags, ManyStates& out)
        : ways_(ways), lags_(lags), out_(out), rows_(ways.x_mm.rows()), lanes_(lanes_of(ways, lags)) {
        for (Lanes* numbers : {&out.contact_x_mm, &out.contact_y_mm, &out.heading_x, &out.heading_y})
            numbers->resize(rows_, lanes_);
        out.taut.resize(rows_, lanes_);
        does_.assign(std::size_t(lanes_) + many::kWidest, 0.0);
        known_.assign(std::size_t(lanes_), 0);
        waits_from_.assign(std::size_t(lanes_), 0);
        headed_.assign(std::size_t(lanes_), 0);
        left_.resize(std::size_t(lanes_));
        prepare_laws();
    }

    static Index lanes_of(const ManyWays& ways, const std::vector<LagLaw<double>>& lags) {
        return std::max(ways.x_mm.cols(), Index(lags.size()));
    }

    void run() {
        look_at(0);
        for (Index lane = 0; lane < lanes_; ++lane) begin(lane);
        for (Index i = 1; i < rows_; ++i) {
            checkpoint(int(lanes_));
            look_at(i);
            std::copy_n(&out_.taut(i - 1, 0), lanes_, &out_.taut(i, 0));
            const std::size_t left = quiet(i);
            for (std::size_t k = 0; k < left; ++k) step(i, left_[k]);
        }
    }

 private:
    const LagLaw<double>& law(Index lane) const { return lags_[lags_.size() == 1 ? 0 : std::size_t(lane)]; }
    Vec2<double> tcp(Index i, Index lane) const {
        const Index k = lane_of(ways_.x_mm, lane);
        return {ways_.x_mm(i, k), ways_.y_mm(i, k)};
    }
    double depth(Index i, Index lane) const { return ways_.depth_mm(i, lane_of(ways_.depth_mm, lane)); }
    double turn(Index i, Index lane) const {
        return ways_.turn_rad.rows() == 0 ? 0.0 : ways_.turn_rad(i, lane_of(ways_.turn_rad, lane));
    }

    /// Refuses what nothing can be computed with: each row shortly before it is needed, since it is in the cache then.
    void look_at(Index i) const {
        const Index n = ways_.x_mm.cols();
        const double *x = &ways_.x_mm(i, 0), *y = &ways_.y_mm(i, 0), *depth = &ways_.depth_mm(i, 0);
        int bad = 0;
        for (Index k = 0; k < n; ++k)
            bad |= int(!(std::abs(x[k]) <= kLargestMm)) | int(!(std::abs(y[k]) <= kLargestMm)) |
                   int(!(depth[k] >= -kLargestMm && depth[k] <= shallowest_));
        const bool bends = ways_.turn_rad.rows() > 0;
        if (bends && i > 0) bad |= int(!(ways_.turn_rad.row(i - 1).abs() <= kMostTurn).all());
        if (bends && i > 0)
            bad |= int((ways_.turn_rad.row(i - 1) != 0.0 &&
                        (ways_.depth_mm.row(i - 1) - ways_.depth_mm.row(i)).abs() > kRounded)
                           .any());
        if (!bad) return;
        if (i > 0) refuse_row(ways_, lags_, i - 1);  // its turn
        refuse_row(ways_, lags_, i);
    }

    void prepare_laws() {
        for (const LagLaw<double>& one : lags_) shallowest_ = std::min(shallowest_, one.pieces.back().hi + kRounded);
        laws_.shared = lags_.size() == 1 && lags_[0].pieces.size() == 1;
        laws_.stride = laws_.shared ? many::kWidest : std::size_t(lanes_);
        for (const LagLaw<double>& one : lags_)
            for (const auto& piece : one.pieces) laws_.degree = std::max(laws_.degree, piece.degree);
        const auto degree = std::size_t(laws_.degree), more = many::kWidest;
        for (auto* numbers : {&laws_.lo, &laws_.hi, &laws_.steepest, &laws_.clear2})
            numbers->assign(laws_.stride + more, 0.0);
        laws_.coefficients.assign((degree + 1) * laws_.stride + more, 0.0);
        laws_.root_real.assign(degree * laws_.stride + more, INFINITY);
        laws_.root_imag.assign(degree * laws_.stride + more, 0.0);
        piece_.assign(laws_.shared ? 1 : std::size_t(lanes_), nullptr);
    }

    /// The piece that holds at a depth, as the vectors see it.
    void load_piece(Index lane, double at) {
        const std::size_t which = laws_.shared ? 0 : std::size_t(lane);
        const LagLaw<double>& from = law(lane);
        const LawPiece<double>& piece = from.piece(at);
        if (piece_[which] == &piece) return;
        piece_[which] = &piece;
        const bool only = from.pieces.size() == 1;
        for (std::size_t k = which; k < (laws_.shared ? laws_.stride : which + 1); ++k) {
            laws_.lo[k] = from.rigid ? INFINITY : only ? -INFINITY : piece.lo;
            laws_.hi[k] = from.rigid ? -INFINITY : only ? INFINITY : piece.hi;
            laws_.steepest[k] = piece.steepest;
            laws_.clear2[k] = piece.clear2;
            for (int power = 0; power <= laws_.degree; ++power)
                laws_.coefficients[std::size_t(power) * laws_.stride + k] =
                    power <= piece.degree ? piece.coefficients[std::size_t(power)] : 0.0;
            for (std::size_t root = 0; root < std::size_t(laws_.degree); ++root) {
                const bool is = root < piece.roots.size();
                laws_.root_real[root * laws_.stride + k] = is ? piece.roots[root].real() : INFINITY;
                laws_.root_imag[root * laws_.stride + k] = is ? piece.roots[root].imag() : 0.0;
            }
        }
    }

    many::StateRow row(Index i) {
        return {&out_.contact_x_mm(i, 0), &out_.contact_y_mm(i, 0), &out_.heading_x(i, 0), &out_.heading_y(i, 0)};
    }

    /// How many lanes are left to step().
    std::size_t quiet(Index i) {
        const bool bends = ways_.turn_rad.rows() > 0 && (ways_.turn_rad.row(i - 1) != 0.0).any();
        if (!bends) {
            const many::WayRow way{&ways_.x_mm(i - 1, 0), &ways_.y_mm(i - 1, 0), &ways_.depth_mm(i - 1, 0),
                                   &ways_.x_mm(i, 0),     &ways_.y_mm(i, 0),     &ways_.depth_mm(i, 0)};
            return many::carry_quiet(std::size_t(lanes_), ways_.x_mm.cols() == 1, way, laws_, does_.data(), row(i - 1),
                                     row(i), left_.data());
        }
        std::iota(left_.begin(), left_.end(), 0);
        return left_.size();
    }

    LagState<double> state(Index i, Index lane) const {
        LagState<double> at;
        at.contact = {out_.contact_x_mm(i, lane), out_.contact_y_mm(i, lane)};
        at.heading = {out_.heading_x(i, lane), out_.heading_y(i, lane)};
        at.taut = out_.taut(i, lane) != 0;
        at.heading_known = known_[std::size_t(lane)] != 0;
        return at;
    }

    void put(Index i, Index lane, const LagState<double>& at) {
        out_.contact_x_mm(i, lane) = at.contact.x();
        out_.contact_y_mm(i, lane) = at.contact.y();
        out_.heading_x(i, lane) = at.heading.x();
        out_.heading_y(i, lane) = at.heading.y();
        out_.taut(i, lane) = at.taut ? 1 : 0;
        const auto k = std::size_t(lane);
        const bool down = depth(i, lane) >= 0.0;
        does_[k] = at.taut ? many::kTaut : down && at.heading_known ? many::kResting : 0.0;
        if (waits_from_[k] >= 0 && (at.heading_known || (at.taut && !law(lane).rigid))) {
            for (Index row = waits_from_[k]; row < i; ++row) {
                out_.heading_x(row, lane) = at.heading.x();
                out_.heading_y(row, lane) = at.heading.y();
            }
            waits_from_[k] = -1;
            headed_[k] = 1;
        }
        known_[k] = at.heading_known ? 1 : 0;
        load_piece(lane, std::max(0.0, depth(i, lane)));
    }

    LagState<double> in_air(const Vec2<double>& q, LagState<double> before) const {
        before.contact = q;
        before.taut = false;
        return before;
    }

    LagState<double> set_down(const Vec2<double>& q, const LagState<double>& before) const {
        LagState<double> at = touch_down(q);
        at.heading = before.heading;
        return at;
    }

    void begin(Index lane) {
        const Vec2<double> q = tcp(0, lane);
        const double d = depth(0, lane);
        LagState<double> at;
        if (d < 0.0) {
            at = in_air(q, at);
        } else {
            at = touch_down(q);
            if (d > 0.0) advance(law(lane), Move<double>(q, q, 0.0, d), at);
        }
        put(0, lane, at);
    }

    /// One lane from the row before to row i, as a pass is walked.
    void step(Index i, Index lane) {
        const Vec2<double> a = tcp(i - 1, lane), b = tcp(i, lane);
        const double da = depth(i - 1, lane), db = depth(i, lane), bend = turn(i - 1, lane);
        LagState<double> at = state(i - 1, lane);
        if (da >= 0.0 && db >= 0.0) {
            if (bend != 0.0 && a != b)
                advance(law(lane), arc_between<double>(a, b, bend, da), at);
            else
                advance(law(lane), Move<double>(a, b, da, db), at);
        } else if (da >= 0.0 || db >= 0.0) {
            const double crossing = da / (da - db);
            const Vec2<double> c = a + crossing * (b - a);
            if (db >= 0.0) {
                at = set_down(c, at);
                if (headed_[std::size_t(lane)]) waits_from_[std::size_t(lane)] = i;
                if (db > 0.0) advance(law(lane), Move<double>(c, b, 0.0, db), at);
            } else {
                if (crossing > 0.0) advance(law(lane), Move<double>(a, c, da, 0.0), at);
                at = in_air(b, at);
            }
        } else {
            at = in_air(b, at);
        }
        put(i, lane, at);
    }

    const ManyWays& ways_;
    const std::vector<LagLaw<double>>& lags_;
    ManyStates& out_;
    Index rows_, lanes_;
    double shallowest_ = INFINITY;  ///< the least depth at which a lag ends
    many::LawLanes laws_;
    std::vector<const LawPiece<double>*> piece_;  ///< of each law, as it stands in laws_
    std::vector<double> does_;                    ///< as carry_quiet asks
    std::vector<unsigned char> known_;            ///< heading_known of each lane
    std::vector<Index> waits_from_;               ///< the first row that waits for a heading, -1: none does
    std::vector<unsigned char> headed_;
    std::vector<int> left_;
};

void refuse_unusable(const ManyWays& ways, const std::vector<LagLaw<double>>& lags) {
    const Index rows = ways.x_mm.rows(), lanes = ways.x_mm.cols();
    const auto sized = [&](const Lanes& numbers, Index n) { return numbers.rows() == n && numbers.cols() == lanes; };
    if (!sized(ways.y_mm, rows) || !sized(ways.depth_mm, rows) ||
        (ways.turn_rad.size() > 0 && !sized(ways.turn_rad, rows - 1)))
        throw Error("sizes-differ", "x, y and depth of many ways need as many rows and lanes each, turns a row less");
    if (rows == 0 || lanes == 0 || lags.empty())
        throw Error("sizes-differ", "many ways need a row, a lane and a lag: one of them is missing");
    if (lanes != 1 && lags.size() != 1 && Index(lags.size()) != lanes) {
        char text[120];
        std::snprintf(text, sizeof text, "%ld ways and %zu lags: where both are many there are as many of each",
                      long(lanes), lags.size());
        throw Error("sizes-differ", text);
    }
    for (const LagLaw<double>& lag : lags)
        if (lag.pieces.empty()) throw Error("law-terms", "a law without pieces says nothing: the depth range is empty");
}

/// What is wrong with row i of the ways.
void refuse_row(const ManyWays& ways, const std::vector<LagLaw<double>>& lags, Index i) {
    char text[160];
    for (const Lanes* numbers : {&ways.x_mm, &ways.y_mm, &ways.depth_mm, &ways.turn_rad}) {
        if (i >= numbers->rows()) continue;  // of turns there is one less
        if (!numbers->row(i).allFinite())
            throw Error("not-finite", "row " + std::to_string(i) + " of many ways has a number that is not finite");
        const double largest = numbers->row(i).abs().maxCoeff(),
                     most = numbers == &ways.turn_rad ? kMostTurn : kLargestMm;
        if (largest <= most) continue;
        const bool turns = numbers == &ways.turn_rad;
        std::snprintf(text, sizeof text,
                      turns ? "row %ld of many ways turns by %.3f rad, outside the range [-6.28, 6.28]"
                            : "row %ld of many ways lies at %.3g mm, outside the range [-1e6, 1e6] mm",
                      long(i), largest);
        const std::array<double, 2> range{-most, most};
        if (turns) throw Error("out-of-range", text, "", largest, range);
        throw Error("geometry-out-of-range", text, "", largest, range);
    }
    if (i < ways.turn_rad.rows() &&
        (ways.turn_rad.row(i) != 0.0 && (ways.depth_mm.row(i) - ways.depth_mm.row(i + 1)).abs() > kRounded).any())
        throw Error("arc-invalid", "the depth changes on an arc after row " + std::to_string(i) + " of many ways");
    for (std::size_t k = 0; k < lags.size(); ++k) {
        const bool one = lags.size() == 1;
        const double hi = lags[k].pieces.back().hi;
        const double deepest =
            one || ways.depth_mm.cols() == 1 ? ways.depth_mm.row(i).maxCoeff() : ways.depth_mm(i, Index(k));
        if (deepest <= hi + kRounded) continue;
        std::snprintf(text, sizeof text, "depth %.3f mm of row %ld is outside the range [0, %.1f] mm of its lag",
                      deepest, long(i), hi);
        throw Error("depth-out-of-range", text, "", deepest, std::array<double, 2>{0.0, hi});
    }
}

}  // namespace

void follow_many(const ManyWays& ways, const std::vector<LagLaw<double>>& lags, ManyStates& out) {
    refuse_unusable(ways, lags);
    Follower(ways, lags, out).run();
}

ManyStates follow_many(const ManyWays& ways, const std::vector<LagLaw<double>>& lags) {
    ManyStates out;
    follow_many(ways, lags, out);
    return out;
}

}  // namespace brushsvg
