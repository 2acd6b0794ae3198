/// Other programs that a study calls: python for what its rows say, valgrind for its counts.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace raypool::studies {

/// Runs a program, found in PATH where its name has no slash, and waits for it. Its standard output and error are
/// ours. It is out of reach of the terminal's Ctrl-C, so that a study that is stopped can finish its case. Returns the
/// exit status, or 128 and the signal that ended it. Throws std::runtime_error where it cannot be started.
int run_process(const std::vector<std::string>& arguments);

inline constexpr const char* kPython = "/usr/bin/python3";  ///< the one that the distribution's matplotlib is for

/// A script of ours: beside the command where it is installed, else in the source tree that it was built from.
std::string own_script(const std::filesystem::path& installed, const std::filesystem::path& source);

}  // namespace raypool::studies
