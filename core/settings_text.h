/// Settings of a render as texts, the way users write them: `dynamic,4`, `tile:16`, `sobol`. A text that makes no sense
/// is an InputError that names the command's option.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/engine.h"

namespace raypool {

/// static, dynamic or guided, with an optional chunk: "dynamic,4". A refusal names `source`, where the text is from.
LoopSchedule parse_schedule(std::string_view text, std::string_view source = "--schedule");
std::string to_string(const LoopSchedule& schedule);

/// pixel, line or tile:N.
Grain parse_grain(std::string_view text);
std::string to_string(const Grain& grain);

/// independent or sobol.
Sampler parse_sampler(std::string_view text);
std::string to_string(Sampler sampler);

/// What OMP_SCHEDULE says, in upper or lower case and with blanks as OpenMP has it, and dynamic where there is none:
/// equal lines are not equal work. What --schedule refuses is refused: of `auto` and of the modifiers monotonic: and
/// nonmonotonic: a record could not say what they came to.
LoopSchedule default_schedule();

/// The whole text as a number in [least, most], or nothing.
std::optional<std::int64_t> parse_integer(std::string_view text, std::int64_t least, std::int64_t most);

/// Sets the image's width, and its height so that the shape stays. Refuses what is not in [1, 65536].
void set_width(Scene& scene, std::int64_t width);

}  // namespace raypool
