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

/// work(), on a thread of its own while this one asks whether to go on: for what a library does in one piece without a
/// checkpoint, seconds at a time. Given up, nobody waits for it: it goes on to its next checkpoint and ends there, so
/// `work` must own all that it reads.
template <class Work>
auto asking_meanwhile(Work work) {
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
        (*task)();  // the system starts no thread: here, then, without polling
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
