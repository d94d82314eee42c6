// The switches of planted faults in C++: fault(k) is true in a process whose BRUSHSVG_FAULT is k. Where
// BRUSHSVG_FAULT_HITS names a folder, the numbers of faults that a test comes by are written there.
#pragma once

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>
#ifdef _WIN32
#include <process.h>
#else
#include <unistd.h>
#endif

namespace brushsvg_faults {

inline const int active = [] {
    const char* number = std::getenv("BRUSHSVG_FAULT");
    return number ? std::atoi(number) : -1;
}();
inline const std::string hits = [] {
    const char* folder = std::getenv("BRUSHSVG_FAULT_HITS");
    return std::string(folder ? folder : "");
}();
inline const bool watched = !hits.empty();
inline std::atomic<bool> seen[1024];

[[gnu::noinline, gnu::cold]] inline void record(int number) {
    if (seen[number].exchange(true)) return;
    const char* test = std::getenv("PYTEST_CURRENT_TEST");
    const std::string path = hits + "/hits-" + std::to_string(getpid()) + ".txt";
    if (std::FILE* file = std::fopen(path.c_str(), "a")) {
        std::fprintf(file, "%d\t%s\n", number, test ? test : "");
        std::fclose(file);
    }
}

inline bool fault(int number) {
    if (watched && !seen[number].load(std::memory_order_relaxed)) record(number);
    return active == number;
}

/// The same, written down only where the two forms differ.
template <class Original, class Mutated>
bool fault(int number, const Original& original, const Mutated& mutated) {
    if (watched && !seen[number].load(std::memory_order_relaxed) && original() != mutated()) record(number);
    return active == number;
}

}  // namespace brushsvg_faults

extern "C" [[gnu::visibility("default"), gnu::used]] inline void brushsvg_faults_reset() {
    for (auto& each : brushsvg_faults::seen) each = false;
}
