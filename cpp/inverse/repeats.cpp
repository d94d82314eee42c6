#include "inverse/repeats.hpp"

#include <cmath>
#include <map>
#include <optional>
#include <string>

namespace brushsvg {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

// Largest difference of equal coordinates [mm]. Regions have them on a grid of 1e-5 mm, programs round them to 1e-3 mm.
constexpr double kEqualMm = 1e-4;

/// A number that is the same for equal points, and differs for nearly all others.
struct Signature {
    double mm;
    double tolerance_mm;  ///< how much it differs for points that count as equal
};
Signature signature_of(const Points& points) {
    Signature out{0.0, 0.0};
    const Eigen::RowVector2d middle = points.colwise().mean();
    for (Index k = 0; k < points.rows(); ++k) {
        const Vector2d weights(std::cos(1.4 * double(k)), std::sin(1.7 * double(k) + 1.0));  // without a pattern
        out.mm += (points.row(k) - middle).dot(weights);
        out.tolerance_mm += kEqualMm * weights.lpNorm<1>();
    }
    return out;
}

}  // namespace

std::vector<Original> find_originals(const std::vector<Points>& points_mm,
                                     const std::function<bool(std::size_t, std::size_t)>& are_alike) {
    std::vector<Original> out;
    std::map<Index, std::multimap<double, std::size_t>> originals;  // by the number of points and their signature
    for (std::size_t k = 0; k < points_mm.size(); ++k) {
        out.push_back({k, Vector2d::Zero()});
        const Points& points = points_mm[k];
        if (points.rows() == 0 || !points.allFinite()) continue;  // refused where it is used
        const Signature signature = signature_of(points);
        auto& some = originals[points.rows()];
        for (auto each = some.lower_bound(signature.mm - signature.tolerance_mm);
             each != some.end() && each->first <= signature.mm + signature.tolerance_mm; ++each) {
            const Points displacements_mm = points - points_mm[each->second];
            const Eigen::RowVector2d mean = displacements_mm.colwise().mean();
            if ((displacements_mm.rowwise() - mean).cwiseAbs().maxCoeff() > kEqualMm || !are_alike(k, each->second))
                continue;
            out.back() = {each->second, mean.transpose()};
            break;
        }
        if (out.back().index == k) some.emplace(signature.mm, k);
    }
    return out;
}

std::vector<Original> find_originals(const std::vector<Stroke>& strokes) {
    std::vector<Points> points_mm;
    for (const Stroke& stroke : strokes) points_mm.push_back(points_of(stroke));
    return find_originals(points_mm, [&](std::size_t k, std::size_t j) { return are_alike(strokes[k], strokes[j]); });
}

Points joined(const Rings& lists) {
    Index count = 0;
    for (const Points& list : lists) count += list.rows();
    Points out(count, 2);
    count = 0;
    for (const Points& list : lists) {
        out.middleRows(count, list.rows()) = list;
        count += list.rows();
    }
    return out;
}

Points points_of(const Stroke& stroke) {
    Rings lists = stroke.target_mm;
    lists.push_back(Eigen::Map<const Points>(stroke.middle_mm.data(), 4 * stroke.middle_mm.rows(), 2));
    return joined(lists);
}

bool are_alike(const Rings& a, const Rings& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t k = 0; k < a.size(); ++k)
        if (a[k].rows() != b[k].rows()) return false;
    return true;
}

bool are_alike(const Stroke& a, const Stroke& b) {
    if (a.closed != b.closed || a.start_covered != b.start_covered || a.end_covered != b.end_covered ||
        a.settings.start != b.settings.start || a.settings.end != b.settings.end ||
        a.half_width.size() != b.half_width.size() || !are_alike(a.target_mm, b.target_mm))
        return false;
    for (std::size_t k = 0; k < a.half_width.size(); ++k)
        if (!(std::abs(a.half_width[k].at - b.half_width[k].at) <= 1e-9) ||
            !(std::abs(a.half_width[k].half_width_mm - b.half_width[k].half_width_mm) <= kEqualMm))
            return false;
    return true;
}

CompensatedPass move_to(const Stroke& stroke, CompensatedPass done, const Vector2d& displacement_mm) {
    Pass& pass = done.pass;
    pass.stroke = stroke.id;
    pass.layer = stroke.layer;
    pass.colour = stroke.colour;
    const std::optional<std::string> end = pass.settings.end;  // of the options, if the stroke has none
    pass.settings = stroke.settings;
    pass.settings.end = end;
    move(pass.poses_mm, displacement_mm);
    for (Arc& arc : pass.arcs) arc.centre_mm += displacement_mm;
    for (int axis : {0, 1}) done.tracking_error.at_mm[std::size_t(axis)] += displacement_mm[axis];
    for (Warning& warning : done.warnings) warning.where = stroke.id;
    return done;
}

}  // namespace brushsvg
