/// What tests of output files share: how a text is written, what is refused, and a process that may be spoilt.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/base/output_file.h"

namespace raypool::output_files {

inline void write_text(const std::filesystem::path& path, std::string_view text) {
    write_whole(path, std::as_bytes(std::span(text)));
}

/// The text of the InputError that `action` throws; empty if it throws none.
inline std::string error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

/// What `check` returns, run in a process of its own because it changes the whole process.
inline int in_child(const std::function<int()>& check) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(check());
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace raypool::output_files
