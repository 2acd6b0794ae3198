/// Settings of a render as texts, the way users write them: `dynamic,4`, `tile:16`, `sobol`. A text that makes no sense
/// is an InputError that names the command's option.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/runtime/engine.h"

namespace raypool {

/// balanced; or static, dynamic, guided or tasks, with an optional chunk: "dynamic,4".
LoopSchedule parse_schedule(std::string_view text);
std::string to_string(const LoopSchedule& schedule);

/// pixel, line or tile:N.
Grain parse_grain(std::string_view text);
std::string to_string(const Grain& grain);

/// independent or sobol.
Sampler parse_sampler(std::string_view text);
std::string to_string(Sampler sampler);

/// none, light or mis.
LightSampling parse_light_sampling(std::string_view text);
std::string to_string(LightSampling sampling);

/// What OMP_SCHEDULE says, if it is set, in upper or lower case and with blanks as OpenMP has it: static, dynamic or
/// guided. All else is refused: of `auto` and of the modifiers monotonic: and nonmonotonic: a record could not say what
/// they came to.
std::optional<LoopSchedule> schedule_of_environment();

/// What --schedule says, else OMP_SCHEDULE; else items are balanced, or, where there is a --grain, its items go to
/// whichever thread is free: equal lines are not equal work.
LoopSchedule chosen_schedule(const std::optional<std::string>& schedule, const std::optional<std::string>& grain);

/// The whole text as a number in [least, most], or nothing.
std::optional<std::int64_t> parse_integer(std::string_view text, std::int64_t least, std::int64_t most);

/// Sets the image's width, and its height so that the shape stays. Refuses what is not in [1, 65536].
void set_width(Scene& scene, std::int64_t width);
/// Sets both; of which one is 0, that one so that the shape stays; nothing where both are. Refuses the same.
void set_size(Scene& scene, std::int64_t width, std::int64_t height);

}  // namespace raypool
