#include "cluster/ranks.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "core/base/error.h"

namespace raypool::cluster {

namespace {

/// Of mpirun (Open MPI), of MPICH and Slurm's PMI-2, and of Slurm's PMIx.
bool is_launched() {
    constexpr const char* kMarks[] = {"OMPI_COMM_WORLD_SIZE", "PMI_RANK", "PMIX_RANK"};
    return std::any_of(std::begin(kMarks), std::end(kMarks), [](const char* name) { return std::getenv(name); });
}

/// How many processes were started, as the launchers tell it. SLURM_NTASKS would not: it is also there in a batch
/// script, which runs once.
int started_count() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
        if (const char* text = std::getenv(name)) return std::atoi(text);
    return 1;
}

}  // namespace

std::unique_ptr<Ranks> join_ranks() {
    if (!is_launched()) {
        auto alone = std::make_unique<Ranks>();
        alone->set_separate_count(started_count());
        return alone;
    }
    // MPI must see the symbols of its own plug-ins' host (RTLD_GLOBAL), and never be unloaded.
    void* module = dlopen(RAYPOOL_MPI_MODULE, RTLD_NOW | RTLD_GLOBAL | RTLD_NODELETE);
    if (module != nullptr) {
        using Make = Ranks* (*)();
        std::unique_ptr<Ranks> ranks(reinterpret_cast<Make>(dlsym(module, "raypool_make_ranks"))());
        if (const int count = started_count(); count > 1 && ranks->count() == 1)
            throw InputError(fmt::format(
                "{} ranks were started, and each would render the whole image: their MPI and this raypool's do not "
                "understand each other. Start it with the mpirun of the MPI that it was built with, or srun --mpi=pmix",
                count));
        return ranks;
    }
    if (const int count = started_count(); count > 1)
        throw InputError(fmt::format(
            "{} ranks were started, and each would render the whole image: this raypool was built without MPI, or "
            "cannot load it ({}). Split the render with --samples and `raypool merge`, or build where CMake finds MPI",
            count, dlerror()));
    return std::make_unique<Ranks>();
}

}  // namespace raypool::cluster
