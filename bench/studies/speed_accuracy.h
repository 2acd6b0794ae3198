/// What the two files of the study of speed and accuracy share: its configurations, and what its rows say.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/accuracy/configuration.h"
#include "bench/studies/study.h"

namespace raypool::studies::speed_accuracy {

/// Kinds of rows.
inline constexpr const char* kReference = "reference";
inline constexpr const char* kBias = "bias";
inline constexpr const char* kRun = "run";

/// The fast pool in float: what the others are held against. depth 0: the usual one.
accuracy::Configuration base_configuration(std::int64_t depth);

/// The base, what differs from it in one thing, and the combinations that are worth a look.
std::vector<accuracy::Configuration> configurations(std::int64_t depth, bool has_glass);

Summary summarise(const Table& data, const StudyOptions& options);

}  // namespace raypool::studies::speed_accuracy
