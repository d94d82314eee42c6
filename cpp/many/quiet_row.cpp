#include "quiet_row.hpp"

#ifdef BRUSHSVG_HIGHWAY

// what AVX-512 as such and SSE4 have does not gain by their neighbours
#define HWY_DISABLED_TARGETS (HWY_AVX3_DL | HWY_SSSE3)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "quiet_row.cpp"
#include <hwy/foreach_target.h>
// after it
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "brushsvg/lag.hpp"

HWY_BEFORE_NAMESPACE();
namespace brushsvg::many::HWY_NAMESPACE {

#if HWY_HAVE_FLOAT64
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kWidest>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

/// The laws of a group of lanes.
struct Laws {
    const LawLanes& all;
    std::size_t at;

    HWY_INLINE V load(const std::vector<double>& numbers, std::size_t row = 0) const {
        return hn::LoadU(D(), numbers.data() + row * all.stride + at);
    }
    HWY_INLINE V lever(V depth) const {
        V r = load(all.coefficients, std::size_t(all.degree));
        for (int k = all.degree; k-- > 0;) r = hn::MulAdd(r, depth, load(all.coefficients, std::size_t(k)));
        return r;
    }
    /// Squared distance of the nearest root from a depth.
    HWY_INLINE V nearest_root(V depth) const {
        V nearest = hn::Set(D(), std::numeric_limits<double>::infinity());
        for (std::size_t k = 0; k < std::size_t(all.degree); ++k) {
            const V dx = hn::Sub(load(all.root_real, k), depth), dy = load(all.root_imag, k);
            nearest = hn::Min(nearest, hn::MulAdd(dx, dx, hn::Mul(dy, dy)));
        }
        return nearest;
    }
};

/// Mean of 1/r over [middle - half, middle + half] by three nodes, with one division; and r at one more depth. Four
/// polynomials at once: each coefficient is read once, and none waits for the one before.
HWY_INLINE V mean_reciprocal(const Laws& law, V middle, V half, V depth, V& lever) {
    using G = detail::Gauss<3>;
    const D d;
    const V step = hn::Mul(half, hn::Set(d, G::x[2])), above = hn::Add(middle, step), below = hn::Sub(middle, step);
    V a = law.load(law.all.coefficients, std::size_t(law.all.degree)), b = a, c = a;
    lever = a;
    for (int k = law.all.degree; k-- > 0;) {
        const V next = law.load(law.all.coefficients, std::size_t(k));
        a = hn::MulAdd(a, above, next);
        b = hn::MulAdd(b, below, next);
        c = hn::MulAdd(c, middle, next);
        lever = hn::MulAdd(lever, depth, next);
    }
    const V ab = hn::Mul(a, b), both = hn::Mul(hn::Set(d, G::w[0]), hn::Add(a, b));
    return hn::Div(hn::MulAdd(both, c, hn::Mul(hn::Set(d, G::w[1]), ab)), hn::Mul(ab, c));
}

/// The same by more nodes.
template <int N>
HWY_INLINE V mean_reciprocal(const Laws& law, V middle, V half) {
    using G = detail::Gauss<N>;
    const D d;
    V sum = hn::Zero(d);
    for (int i = 0; i < N / 2; ++i) {
        const V step = hn::Mul(half, hn::Set(d, G::x[i]));
        const V a = law.lever(hn::Add(middle, step)), b = law.lever(hn::Sub(middle, step));
        sum = hn::Add(sum, hn::Div(hn::Mul(hn::Set(d, G::w[i]), hn::Add(a, b)), hn::Mul(a, b)));
    }
    if (N % 2 == 1) sum = hn::Add(sum, hn::Div(hn::Set(d, G::w[N / 2]), law.lever(middle)));
    return sum;
}

struct Motion {
    V from_x, from_y, to_x, to_y, depth_from, depth_to;
};

struct Patch {
    V contact_x, contact_y, heading_x, heading_y;
};

/// Of lanes that are taut and stay so. ok: for which of them it holds.
HWY_INLINE Patch drag(const Laws& law, const Motion& m, const Patch& before, M& ok) {
    const D d;
    const V one = hn::Set(d, 1.0), none = hn::Zero(d);
    const V by_x = hn::Sub(m.to_x, m.from_x), by_y = hn::Sub(m.to_y, m.from_y);
    const V deeper = hn::Sub(m.depth_to, m.depth_from);
    const V length = hn::Sqrt(hn::MulAdd(by_x, by_x, hn::Mul(by_y, by_y)));
    ok = hn::And(ok, hn::Gt(length, none));
    const V share = hn::Div(one, length), along_x = hn::Mul(by_x, share), along_y = hn::Mul(by_y, share);
    const V a = hn::MulAdd(before.heading_x, along_x, hn::Mul(before.heading_y, along_y));
    const V b = hn::MulSub(along_x, before.heading_y, hn::Mul(along_y, before.heading_x));
    ok = hn::And(ok, hn::Ge(hn::Mul(length, a), hn::Mul(hn::Abs(deeper), law.load(law.all.steepest))));  // a >= 0

    const V half = hn::Mul(hn::Set(d, 0.5), deeper), middle = hn::Add(m.depth_from, half), h2 = hn::Mul(half, half);
    const auto all_beyond = [&](V squared, double times) {
        return hn::AllTrue(d, hn::Or(hn::Gt(squared, hn::Mul(hn::Set(d, times * times), h2)), hn::Not(ok)));
    };
    V r, mean = mean_reciprocal(law, middle, half, m.depth_to, r);
    if (HWY_UNLIKELY(!all_beyond(law.load(law.all.clear2), 73.0))) {
        const V nearest = law.nearest_root(middle);
        if (!all_beyond(nearest, 73.0)) {
            if (all_beyond(nearest, 10.0)) {
                mean = mean_reciprocal<5>(law, middle, half);
            } else {
                ok = hn::And(ok, hn::Gt(nearest, hn::Mul(hn::Set(d, 1.9 * 1.9), h2)));
                mean = mean_reciprocal<12>(law, middle, half);
            }
        }
    }
    const V decay = hn::Exp(d, hn::Neg(hn::Mul(length, mean)));
    const V x = hn::Add(one, a), y = hn::Mul(decay, b), x2 = hn::Mul(x, x), y2 = hn::Mul(y, y);
    const V whole = hn::Div(one, hn::Add(x2, y2));
    const V c = hn::Mul(hn::Sub(x2, y2), whole), s = hn::Mul(hn::Mul(hn::Set(d, 2.0), hn::Mul(x, y)), whole);
    Patch after;
    after.heading_x = hn::MulSub(c, along_x, hn::Mul(s, along_y));
    after.heading_y = hn::MulAdd(c, along_y, hn::Mul(s, along_x));
    after.contact_x = hn::NegMulAdd(r, after.heading_x, m.to_x);
    after.contact_y = hn::NegMulAdd(r, after.heading_y, m.to_y);
    return after;
}

/// Of lanes that rest and go on to: the way to the TCP is shorter, at both ends, than any lever in between.
HWY_INLINE Patch rest(const Laws& law, const Motion& m, const Patch& before, M& ok) {
    const D d;
    const V x0 = hn::Sub(m.from_x, before.contact_x), y0 = hn::Sub(m.from_y, before.contact_y);
    const V x1 = hn::Sub(m.to_x, before.contact_x), y1 = hn::Sub(m.to_y, before.contact_y);
    const V at0 = hn::MulAdd(x0, x0, hn::Mul(y0, y0)), at1 = hn::MulAdd(x1, x1, hn::Mul(y1, y1));
    const V change = hn::Mul(hn::Abs(hn::Sub(m.depth_to, m.depth_from)), law.load(law.all.steepest));
    const V both = hn::Add(law.lever(m.depth_from), law.lever(m.depth_to));
    const V least = hn::Mul(hn::Set(d, 0.5 * (1.0 - 1e-9)), hn::Sub(both, change));
    const V none = hn::Zero(d);
    ok = hn::And(ok, hn::And(hn::Gt(least, none), hn::Lt(hn::Max(at0, at1), hn::Mul(least, least))));
    ok = hn::And(ok, hn::Gt(at1, none));
    const V share = hn::Div(hn::Set(d, 1.0), hn::Sqrt(at1));
    return {before.contact_x, before.contact_y, hn::Mul(x1, share), hn::Mul(y1, share)};
}

/// One group of lanes, from memory to memory; which of them went well.
template <bool kOneWay>
HWY_INLINE M carry_group(const Laws& law, const WayRow& way, const double* does, const StateRow& before,
                         const StateRow& after) {
    const D d;
    const auto told = [&](const double* numbers) { return kOneWay ? hn::Set(d, *numbers) : hn::LoadU(d, numbers); };
    const Motion m{told(way.x0), told(way.y0), told(way.x1), told(way.y1), told(way.depth0), told(way.depth1)};
    Patch patch{hn::Zero(d), hn::Zero(d), hn::LoadU(d, before.heading_x), hn::LoadU(d, before.heading_y)};
    const V none = hn::Zero(d), lo = hn::Max(law.load(law.all.lo), none), hi = law.load(law.all.hi);
    const M on_piece =
        hn::And(hn::Ge(hn::Min(m.depth_from, m.depth_to), lo), hn::Le(hn::Max(m.depth_from, m.depth_to), hi));
    const V how = hn::LoadU(d, does);
    const M drags = hn::And(hn::Eq(how, hn::Set(d, kTaut)), on_piece);
    const M rests = hn::And(hn::Eq(how, hn::Set(d, kResting)), on_piece);
    M went = drags;
    Patch now = drag(law, m, patch, went);
    if (HWY_UNLIKELY(!hn::AllFalse(d, rests))) {
        patch.contact_x = hn::LoadU(d, before.contact_x);
        patch.contact_y = hn::LoadU(d, before.contact_y);
        M rested = rests;
        const Patch resting = rest(law, m, patch, rested);
        now.contact_x = hn::IfThenElse(rested, resting.contact_x, now.contact_x);
        now.contact_y = hn::IfThenElse(rested, resting.contact_y, now.contact_y);
        now.heading_x = hn::IfThenElse(rested, resting.heading_x, now.heading_x);
        now.heading_y = hn::IfThenElse(rested, resting.heading_y, now.heading_y);
        went = hn::Or(went, rested);
    }
    hn::StoreU(now.contact_x, d, after.contact_x);
    hn::StoreU(now.contact_y, d, after.contact_y);
    hn::StoreU(now.heading_x, d, after.heading_x);
    hn::StoreU(now.heading_y, d, after.heading_y);
    return went;
}

template <bool kOneWay>
std::size_t carry(std::size_t lanes, const WayRow& way, const LawLanes& laws, const double* does,
                  const StateRow& before, const StateRow& after, int* left) {
    const D d;
    const std::size_t width = hn::Lanes(d);
    std::size_t count = 0;
    const auto note = [&](M went, std::size_t from, std::size_t n) {
        if (HWY_LIKELY(hn::AllTrue(d, went))) return;
        std::uint8_t bits[kWidest] = {};
        hn::StoreMaskBits(d, went, bits);
        for (std::size_t k = 0; k < n; ++k)
            if (!(bits[k / 8] >> (k % 8) & 1)) left[count++] = int(from + k);
    };
    std::size_t at = 0;
    for (; at + width <= lanes; at += width) {
        const std::size_t own = kOneWay ? 0 : at;
        const WayRow here{way.x0 + own, way.y0 + own, way.depth0 + own, way.x1 + own, way.y1 + own, way.depth1 + own};
        const StateRow from{before.contact_x + at, before.contact_y + at, before.heading_x + at, before.heading_y + at};
        const StateRow to{after.contact_x + at, after.contact_y + at, after.heading_x + at, after.heading_y + at};
        note(carry_group<kOneWay>(Laws{laws, laws.shared ? 0 : at}, here, does + at, from, to), at, width);
    }
    if (at == lanes) return count;
    // the last lanes, in rows as wide as a vector
    const std::size_t rest = lanes - at;
    double numbers[14][kWidest] = {};
    const auto copied = [&](const double* from, double* into) {
        std::copy_n(from + at, rest, into);
        return into;
    };
    const auto of_way = [&](const double* from, double* into) { return kOneWay ? from : copied(from, into); };
    const WayRow here{of_way(way.x0, numbers[0]), of_way(way.y0, numbers[1]), of_way(way.depth0, numbers[2]),
                      of_way(way.x1, numbers[3]), of_way(way.y1, numbers[4]), of_way(way.depth1, numbers[5])};
    const StateRow from{copied(before.contact_x, numbers[6]), copied(before.contact_y, numbers[7]),
                        copied(before.heading_x, numbers[8]), copied(before.heading_y, numbers[9])};
    const StateRow to{numbers[10], numbers[11], numbers[12], numbers[13]};
    note(carry_group<kOneWay>(Laws{laws, laws.shared ? 0 : at}, here, does + at, from, to), at, rest);
    std::copy_n(to.contact_x, rest, after.contact_x + at);
    std::copy_n(to.contact_y, rest, after.contact_y + at);
    std::copy_n(to.heading_x, rest, after.heading_x + at);
    std::copy_n(to.heading_y, rest, after.heading_y + at);
    return count;
}

std::size_t carry_row(std::size_t lanes, bool shared_way, const WayRow& way, const LawLanes& laws, const double* does,
                      const StateRow& before, const StateRow& after, int* left) {
    return shared_way ? carry<true>(lanes, way, laws, does, before, after, left)
                      : carry<false>(lanes, way, laws, does, before, after, left);
}

#else

std::size_t carry_row(std::size_t lanes, bool, const WayRow&, const LawLanes&, const double*, const StateRow&,
                      const StateRow&, int* left) {
    for (std::size_t k = 0; k < lanes; ++k) left[k] = int(k);
    return lanes;
}

#endif

}  // namespace brushsvg::many::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brushsvg::many {

HWY_EXPORT(carry_row);

std::size_t carry_quiet(std::size_t lanes, bool shared_way, const WayRow& way, const LawLanes& law, const double* does,
                        const StateRow& before, const StateRow& after, int* left) {
    return HWY_DYNAMIC_DISPATCH(carry_row)(lanes, shared_way, way, law, does, before, after, left);
}

}  // namespace brushsvg::many
#endif

#else  // without Highway all lanes go one by one

namespace brushsvg::many {

std::size_t carry_quiet(std::size_t lanes, bool, const WayRow&, const LawLanes&, const double*, const StateRow&,
                        const StateRow&, int* left) {
    for (std::size_t k = 0; k < lanes; ++k) left[k] = int(k);
    return lanes;
}

}  // namespace brushsvg::many

#endif
