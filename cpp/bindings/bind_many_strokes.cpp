#include "bindings.hpp"
#include "law_between.hpp"
#include "many_strokes.hpp"
#include "marks_way.hpp"

namespace {

using namespace brushsvg;
using Eigen::Index;
using Table = py::array_t<double, py::array::c_style>;

/// Two numbers of each row and lane.
Table pairs(const Lanes& x, const Lanes& y) {
    Table out({x.rows(), Index(2), x.cols()});
    double* to = out.mutable_data();
    for (Index i = 0; i < x.rows(); ++i)
        for (const Lanes* numbers : {&x, &y}) to = std::copy_n(&(*numbers)(i, 0), x.cols(), to);
    return out;
}

py::list follow_lags(const std::vector<Pass>& passes, const std::vector<PassMarks>& marks,
                     const std::vector<Profile>& lags, const std::array<double, 2>& depth_range_mm) {
    if (passes.size() != marks.size())
        throw Error("sizes-differ", std::to_string(passes.size()) + " passes and marks of " +
                                        std::to_string(marks.size()) + ": each pass needs its own");
    std::vector<LagLaw<double>> laws;
    for (const Profile& lag : lags) laws.push_back(law_between(lag, depth_range_mm[0], depth_range_mm[1]));
    std::vector<ManyStates> states(passes.size());
    {
        const Unlocked unlocked;
        on_all_processors(0, passes.size(), [&](std::size_t i) {
            if (const ManyWays way = way_of(passes[i], marks[i]); way.x_mm.rows() > 0)
                states[i] = follow_many(way, laws);
        });
    }
    py::list out;
    for (const ManyStates& each : states)
        out.append(py::make_tuple(pairs(each.contact_x_mm, each.contact_y_mm), pairs(each.heading_x, each.heading_y)));
    return out;
}

}  // namespace

void bind_many_strokes(py::module_& m) {
    m.def("follow_lags", &follow_lags, py::arg("passes"), py::arg("marks"), py::arg("lags"), py::arg("depth_range_mm"),
          R"(What patches of K other lags do on the ways of these passes, at the rows of their marks.

marks: PassMarks of each pass, simulated with one upright brush. lags: Profiles that are positive on depth_range_mm. For
each pass: contacts [mm] and headings as unit vectors, (n, 2, K) each. In the air the contact is the TCP.

Exact at each row, by the closed form; vector instructions carry several lags at once where the library was built with
Highway.)");
}
