#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace brushsvg {

/// work(i) for i in [begin, end) on all processors; of several errors the first stroke's is thrown.
template <class Work>
void on_all_processors(std::size_t begin, std::size_t end, Work&& work) {
    std::atomic<std::size_t> next{begin};
    std::vector<std::exception_ptr> errors(end - begin);
    const auto run = [&] {
        for (std::size_t i = next++; i < end; i = next++) try {
                work(i);
            } catch (...) {
                errors[i - begin] = std::current_exception();
            }
    };
    std::vector<std::thread> others;
    for (unsigned k = 1; k < std::min<std::size_t>(std::thread::hardware_concurrency(), end - begin); ++k)
        others.emplace_back(run);
    run();
    for (std::thread& other : others) other.join();
    for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
}

}  // namespace brushsvg
