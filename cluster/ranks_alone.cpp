// A build without MPI: one process, and a word for those who start several.

#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "cluster/ranks.h"
#include "core/error.h"

namespace raypool::cluster {

namespace {

/// What Open MPI, MPICH and Slurm's PMIx say about how many were started. srun also starts jobs that know no PMIx, each
/// for itself, and those are none of ours.
int started_ranks() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
        if (const char* text = std::getenv(name)) return std::atoi(text);
    const char* tasks = std::getenv("SLURM_STEP_NUM_TASKS");
    return std::getenv("PMIX_RANK") != nullptr && tasks != nullptr ? std::atoi(tasks) : 1;
}

}  // namespace

Ranks::Ranks() {
    if (const int count = started_ranks(); count > 1)
        throw InputError(fmt::format(
            "{} ranks were started, and this raypool was built without MPI: each would render the whole image. "
            "Build it where CMake finds MPI, or split the render with --samples and `raypool merge`",
            count));
}
Ranks::~Ranks() = default;

int Ranks::fail(int status, const std::string& text) const {
    fmt::print(stderr, "raypool: {}\n", text);
    return status;
}

void Ranks::hand_out(std::int64_t count, const Work& work, const Work& /*given*/) {
    for (std::int64_t i = 0; i < count; ++i) work(i);
}
void Ranks::sum_at_first(std::span<std::int64_t> /*values*/) {}
void Ranks::sum_everywhere(std::span<std::int64_t> /*values*/) {}
std::int64_t Ranks::greatest(std::int64_t value) {
    return value;
}
void Ranks::broadcast(std::span<std::byte> /*bytes*/) {}
std::vector<std::vector<std::byte>> Ranks::gather(std::span<const std::byte> bytes) {
    return {{bytes.begin(), bytes.end()}};
}

}  // namespace raypool::cluster
