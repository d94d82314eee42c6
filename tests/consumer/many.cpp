// Two lags on one way, by the installed library.
#include <brushsvg/many/many_strokes.hpp>
#include <cmath>

int main() {
    brushsvg::ManyWays way;
    for (brushsvg::Lanes* numbers : {&way.x_mm, &way.y_mm, &way.depth_mm}) numbers->setZero(3, 1);
    way.x_mm.col(0) << 0.0, 5.0, 10.0;
    way.depth_mm.fill(1.0);
    const auto law = [](double lag) { return brushsvg::make_law({{0.0, 10.0, {lag}}}); };
    const brushsvg::ManyStates states = brushsvg::follow_many(way, {law(2.0), law(3.0)});
    return std::abs(states.contact_x_mm(2, 0) - 8.0) < 1e-12 && std::abs(states.contact_x_mm(2, 1) - 7.0) < 1e-12 ? 0
                                                                                                                  : 1;
}
