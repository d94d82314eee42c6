#pragma once

#include <memory>
#include <optional>

#include "brushsvg/compensate.hpp"
#include "brushsvg/coverage.hpp"
#include "middle_line.hpp"
#include "squared_dot.hpp"
#include "squared_end.hpp"
#include "turned_end.hpp"

namespace brushsvg {

class View;

/// What `auto` takes at both ends of a stroke: what differs less from the wanted mark near them. Passes and pictures
/// that several choices compare are made once.
class Ends {
 public:
    /// stroke: the wanted one as far as the brush goes.
    Ends(const Stroke& wanted, const Stroke& stroke, const Brush& brush, double step_tolerance);
    ~Ends();

    Beginning best_beginning();
    /// Of these two, where the drawn end is a round cap or a ball; elsewhere hidden.
    Beginning hidden_or_turned();
    /// Whether a squared one makes the mark begin still better, by more than can hardly be seen. start: how the stroke
    /// begins without it; whole: the stroke with its way, up to its end.
    bool begins_better(const Stroke& whole, Beginning start);
    /// Whether a dot with corners is more like the wanted one than what is painted without them, begun as start says.
    bool is_better_squared(const SquaredDot& dot, Beginning start);
    /// Of that of the stroke, and of that with a squared end.
    Ending best_ending(const SquaredEnd& squared, Beginning start);
    /// Whether a turned end makes the mark end still rounder.
    bool is_better(const TurnedEnd& turned, Beginning start);

 private:
    template <class Poses>
    bool is_better_at_end(Poses&& poses, Beginning start, double worth);
    const Pass& plain(Beginning start);
    double made_mm() const;
    /// The beginning of a pass, up to the same place as the other's: from there on they are the same.
    Pass begun(const Pass& pass, const Pass& other) const;
    const View& at_beginning();
    const Coverage& exposed_picture();

    Stroke wanted_, stroke_;
    const Brush& brush_;
    Line line_;
    double step_tolerance_;
    std::unique_ptr<View> view_;
    std::optional<Pass> exposed_, hidden_, turned_;
    std::optional<Coverage> exposed_picture_;
};

}  // namespace brushsvg
