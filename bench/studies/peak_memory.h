/// How much memory something takes while it runs.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

namespace raypool::studies {

/// Calls work(). Returns the most bytes of memory that this process had at once meanwhile, more than just before: pages
/// that are resident, as the system counts them, so a few of other origin may be among them. Nothing where the system
/// does not say. Not for several threads at a time.
std::optional<std::size_t> peak_growth(const std::function<void()>& work);

}  // namespace raypool::studies
