#include "recursive/stack.h"

#include <pthread.h>

#include <cstdint>

#include "core/base/error.h"
#include "core/math/processor.h"

namespace raypool::recursive {

std::size_t stack_bytes_left() {
    pthread_attr_t attributes;
    RAYPOOL_CHECK(pthread_getattr_np(pthread_self(), &attributes) == 0, "a thread knows its stack");
    void* lowest = nullptr;
    std::size_t size = 0;
    pthread_attr_getstack(&attributes, &lowest, &size);
    pthread_attr_destroy(&attributes);
    return stack_pointer() - reinterpret_cast<std::uintptr_t>(lowest);
}

}  // namespace raypool::recursive
