// A separate program, because it replaces pthread_create. Its version fails after some threads, as in a container that
// limits its processes.
#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <stdexcept>

#include "base/parallel.hpp"
#include "base/run_cancellable.hpp"

unsigned std::thread::hardware_concurrency() noexcept { return 8; }

namespace {

std::atomic<int> allowed{0};  // how many more threads may be started

}  // namespace

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*), void* data) {
    if (allowed-- <= 0) return EAGAIN;
    using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
    static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
    return create(thread, attributes, run, data);
}

int main() {
    int wrong = 0;
    const auto require = [&](bool is_so, const char* what, int threads) {
        if (is_so) return;
        std::printf("with %d threads: %s\n", threads, what);
        ++wrong;
    };
    for (int threads = 0; threads <= 7; ++threads) {
        allowed = threads;
        std::atomic<int> sum{0};
        brushsvg::parallel_for(0, 1000, [&](std::size_t i) { sum += int(i); });
        require(sum == 999 * 1000 / 2, "some of the work was not done once", threads);
        allowed = threads;
        bool is_refused = false;
        try {
            brushsvg::parallel_for(0, 100, [](std::size_t i) {
                if (i == 40) throw std::runtime_error("no");
            });
        } catch (const std::runtime_error&) {
            is_refused = true;
        }
        require(is_refused, "an error of the work was lost", threads);
    }
    for (int threads = 0; threads <= 1; ++threads) {
        allowed = threads;
        require(brushsvg::run_cancellable([] { return 42; }) == 42, "the result was lost", threads);
    }
    return wrong;
}
