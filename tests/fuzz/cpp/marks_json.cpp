// Marks that are read and written read back the same, and what is usable of them has a finite outline.
#include "marks_json.hpp"

#include "fuzzed_input.hpp"
#include "values/require_usable.hpp"

using namespace brushsvg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return fuzz::refusing([&] {
        const Marks marks = io::read_marks(fuzz::text_of(data, size));
        for (const PassMarks& pass : marks.passes) {
            const auto rows = pass.contact_mm.rows();
            fuzz::require(std::size_t(rows) == pass.pose.size() && std::size_t(rows) == pass.heading_rad.size() &&
                              std::size_t(rows) == pass.depth_mm.size() && std::size_t(rows) == pass.taut.size(),
                          "rows are parallel");
            fuzz::require(pass.contact_mm.allFinite() && fuzz::are_finite(pass.depth_mm), "rows are finite");
        }
        const std::string once = io::write_marks(marks);
        const Marks again = io::read_marks(once);
        fuzz::require(again.passes.size() == marks.passes.size(), "as many passes are read back");
        fuzz::require(again.outline_mm.size() == marks.outline_mm.size(), "as many rings are read back");
        fuzz::require(io::write_marks(again) == once, "marks that were written are written the same again");
    });
}
