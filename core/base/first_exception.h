/// How an exception gets out of a parallel region, which none may leave: kept in the thread that threw, thrown behind
/// the region.
///
/// Thread safety: any thread may call run(); rethrow() is for one thread, behind the region.
#pragma once

#include <exception>
#include <mutex>
#include <utility>

namespace raypool {

class FirstException {
  public:
    /// Calls `function`, and keeps what it throws if nothing was thrown before.
    template <class Function>
    void run(Function&& function) noexcept {
        try {
            std::forward<Function>(function)();
        } catch (...) {
            const std::scoped_lock lock(mutex_);
            if (first_ == nullptr) first_ = std::current_exception();
        }
    }
    void rethrow() {
        if (first_ != nullptr) std::rethrow_exception(std::exchange(first_, nullptr));
    }

  private:
    std::mutex mutex_;
    std::exception_ptr first_;
};

}  // namespace raypool
