#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "brushsvg/checkpoint.hpp"

namespace brushsvg {

/// Returns the number of processors. It is queried once, because the system reads a file each time, which needs a
/// thirtieth of the time to convert a page.
inline std::size_t processor_count() {
    static const std::size_t count = std::max(1u, std::thread::hardware_concurrency());
    return count;
}

/// Calls work(i) for i in [begin, end) on all processors. If several calls throw, the error with the lowest i is
/// thrown. If the system starts fewer threads, as in a container with a limit of processes, these threads or this one
/// do the work.
template <class Work>
void parallel_for(std::size_t begin, std::size_t end, Work&& work) {
    std::atomic<std::size_t> next{begin};
    std::vector<std::exception_ptr> errors(end - begin);
    const CancelHandover cancel;
    const auto run = [&] {
        for (std::size_t i = next++; i < end; i = next++) try {
                checkpoint();
                work(i);
            } catch (...) {
                errors[i - begin] = std::current_exception();
            }
    };
    std::mutex mutex;
    std::condition_variable thread_ended;
    const std::size_t threads = std::min(processor_count(), end - begin);
    std::size_t running = 0;
    std::vector<std::thread> others;
    others.reserve(threads);  // from here on, only the start of a thread can fail
    for (std::size_t k = 1; k < threads; ++k) try {
            const std::lock_guard lock(mutex);  // a thread that ends at once must already be counted
            others.emplace_back([&] {
                cancel.take_over();
                run();
                const std::lock_guard lock(mutex);
                --running;
                thread_ended.notify_one();
            });
            ++running;
        } catch (const std::exception&) {
            break;  // no more threads or no memory for them: the running threads do all the work
        }
    run();
    std::exception_ptr cancellation;  // only this thread polls for cancellation, also while it waits
    std::unique_lock lock(mutex);
    while (running > 0) {
        thread_ended.wait_for(lock, std::chrono::milliseconds(50));
        if (!cancellation) try {
                checkpoint(1 << 20);
            } catch (...) {
                cancellation = std::current_exception();
            }
    }
    lock.unlock();
    for (std::thread& other : others) other.join();
    if (cancellation) std::rethrow_exception(cancellation);
    for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
}

}  // namespace brushsvg
