// Says in one line that the processor lacks what the command was compiled for, in place of an illegal instruction: the
// widths of registers, from AVX on. (What else a build for one new processor holds is not asked for.) Runs before
// anything else does, and is itself compiled for any x86-64 processor: so it calls nothing of the project.

#include "cli/processor_check.h"

#include <unistd.h>

#include <cstring>

namespace raypool::cli {

namespace {

/// Whether the processor has a set of instructions by its name in kInstructionSets. True of what comes with AVX anyway.
bool has(const char* name) {
    const auto is = [name](const char* other) { return std::strcmp(name, other) == 0; };
    if (is("avx")) return __builtin_cpu_supports("avx") != 0;
    if (is("fma")) return __builtin_cpu_supports("fma") != 0;
    if (is("avx2")) return __builtin_cpu_supports("avx2") != 0;
    if (is("avx512f")) return __builtin_cpu_supports("avx512f") != 0;
    if (is("avx512cd")) return __builtin_cpu_supports("avx512cd") != 0;
    if (is("avx512bw")) return __builtin_cpu_supports("avx512bw") != 0;
    if (is("avx512dq")) return __builtin_cpu_supports("avx512dq") != 0;
    if (is("avx512vl")) return __builtin_cpu_supports("avx512vl") != 0;
    return true;
}

void say(const char* text) {
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
}

/// Before the constructors of C++, whose priority is 65535.
[[gnu::constructor(101)]] void check_processor() {
    __builtin_cpu_init();
    for (const char* const* name = kNeededInstructionSets.begin; name != kNeededInstructionSets.end; ++name) {
        if (has(*name)) continue;
        say("raypool: this processor lacks ");
        say(*name);
        say(std::strncmp(*name, "avx512", 6) == 0
                ? ", which the command was compiled for: build it on this machine, or with --preset portable\n"
                : ": raypool takes one with AVX2 and FMA\n");
        _exit(2);
    }
}

}  // namespace

}  // namespace raypool::cli
