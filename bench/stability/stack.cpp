// Compiled with -fno-optimize-sibling-calls: recursion stays recursion, as in recursive/render_recursive.cpp.
#include "bench/stability/stack.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "core/base/error.h"
#include "recursive/engine.h"
#include "recursive/tracer.h"

namespace raypool::stability {

namespace {

constexpr std::size_t kStackBytes = std::size_t{8} << 20U;

struct Task {
    Deep how;
    std::int32_t depth;
    CompiledScene<float> scene;
};

CompiledScene<float> inside_sphere() {
    Scene scene;
    scene.width = scene.height = 1;
    scene.textures.emplace_back().even = Vector3d::Ones();
    scene.materials.emplace_back();
    scene.spheres.emplace_back().radius = 10;
    return compile<float>(scene);
}

void* trace(void* argument) {
    const Task& task = *static_cast<const Task*>(argument);
    RenderSettings settings;
    settings.depth = task.depth;
    if (task.how == Deep::Recursion) {
        using Tracer = recursive::Tracer<Features{}, float, NoTestCount, Splitting::Off, recursive::Rules::Plain>;
        Tracer tracer(task.scene, settings, FixedPoint::make(1, 1));
        tracer.sample<recursive::Form::Recursive>(0, 0, 0);
        return nullptr;
    }
    Framebuffer framebuffer(1, 1, FixedPoint::make(1, 1));
    try {
        if (task.how == Deep::Checked) {
            recursive::RecursiveEngine().render(task.scene, settings, framebuffer);
        } else {
            recursive::IterativeEngine().render(task.scene, settings, framebuffer);
        }
    } catch (const InputError&) {  // refused in time
    }
    return nullptr;
}

}  // namespace

bool survives(Deep how, std::int64_t depth) {
    Task task{how, static_cast<std::int32_t>(depth), inside_sphere()};
    const pid_t child = fork();
    RAYPOOL_CHECK(child >= 0, "a process can be made");
    if (child == 0) {
        const rlimit no_core{0, 0};
        setrlimit(RLIMIT_CORE, &no_core);
        std::signal(SIGSEGV, SIG_DFL);  // a sanitizer would tell at length what is meant to happen here
        pthread_attr_t attributes;
        pthread_attr_init(&attributes);
        pthread_attr_setstacksize(&attributes, kStackBytes);
        pthread_t thread{};
        if (pthread_create(&thread, &attributes, trace, &task) != 0) _exit(2);
        pthread_join(thread, nullptr);
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    RAYPOOL_CHECK(!WIFEXITED(status) || WEXITSTATUS(status) == 0, "the process gets its thread");
    return WIFEXITED(status);
}

}  // namespace raypool::stability
