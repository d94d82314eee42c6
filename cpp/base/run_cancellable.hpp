#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <system_error>
#include <thread>
#include <utility>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {

/// Runs work() on its own thread, while this thread polls for cancellation.
///
/// It is for library calls that need seconds without a checkpoint. After a cancellation nobody waits for the work. It
/// continues to its next checkpoint and ends there, so that `work` must own everything that it reads.
template <class Work>
auto run_cancellable(Work work) {
    const auto is_over = std::make_shared<std::atomic<bool>>(false);
    using Task = std::packaged_task<decltype(work())()>;
    const auto task = std::make_shared<Task>([work = std::move(work), is_over]() mutable {
        const CancelWhen ends([is_over] { return is_over->load(); });
        return work();
    });
    auto result = task->get_future();
    std::thread other;
    try {
        other = std::thread([task] { (*task)(); });
    } catch (const std::system_error&) {
        (*task)();  // the system starts no thread: work on this one, without polling
        return result.get();
    }
    try {
        while (result.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) checkpoint(1 << 20);
    } catch (...) {
        is_over->store(true);
        other.detach();
        throw;
    }
    other.join();
    return result.get();
}

}  // namespace brushsvg
