// A brush that is read and written reads back the same to the bit; one that check() admits paints each of its widths.
#include "brush_json.hpp"

#include "fuzzed_input.hpp"
#include "values/require_usable.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return fuzz::refusing([&] {
        const Brush brush = io::read_brush(fuzz::text_of(data, size));
        const std::string once = io::write_brush(brush);
        const Brush again = io::read_brush(once);
        fuzz::require(again.lag.coefficients == brush.lag.coefficients &&
                          again.half_width.coefficients == brush.half_width.coefficients &&
                          again.depth_range_mm == brush.depth_range_mm && again.covariance == brush.covariance,
                      "every number is read back as the same double");
        fuzz::require(io::write_brush(again) == once, "a brush that was written is written the same again");
        remarks(brush);
        if (!fuzz::is_sound(brush)) return;
        require_usable(brush);
        if (!brush.width_follows_depth()) return;
        const auto [narrow, wide] = brush.half_width_range_mm();
        for (int i = 1; i <= 8; ++i) {
            const double half = narrow + (wide - narrow) * i / 8;
            const double depth = brush.depth_for_half_width(half, "fuzzed");
            fuzz::require(depth >= brush.depth_range_mm[0] && depth <= brush.depth_range_mm[1],
                          "the depth for a width is within the brush's range", depth);
            fuzz::require(std::abs(brush.half_width(depth) - half) <= 0.05 + 1e-9 * wide,
                          "the depth for a width paints that width", brush.half_width(depth) - half);
        }
    });
}
