#include "brushsvg/checkpoint.hpp"

#include <atomic>
#include <chrono>
#include <exception>
#include <thread>
#include <utility>

namespace brushsvg {

struct CancelWhen::CancelRequest {
    std::function<bool()> is_over;
    std::thread::id owner = std::this_thread::get_id();
    std::chrono::steady_clock::time_point last_poll{};
    std::exception_ptr cause;
    std::atomic<bool> is_cancelled{false};  ///< cancelled, for the reason in `why`
};

namespace {

/// Amount of work between readings of the clock, and time between calls of is_over.
constexpr int kWorkPerClockReadingUs = 500;
constexpr std::chrono::milliseconds kPollInterval{50};

thread_local CancelWhen::CancelRequest* current_request = nullptr;
thread_local int work_done = 0;

}  // namespace

CancelWhen::CancelWhen(std::function<bool()> is_over)
    : request_(std::make_unique<CancelRequest>()), outer_(current_request) {
    request_->is_over = std::move(is_over);
    current_request = request_.get();
}

CancelWhen::~CancelWhen() { current_request = outer_; }

void checkpoint(int work) {
    if (!current_request) return;
    if (current_request->is_cancelled.load(std::memory_order_acquire)) std::rethrow_exception(current_request->cause);
    if (current_request->owner != std::this_thread::get_id() || (work_done += work) < kWorkPerClockReadingUs) return;
    work_done = 0;
    const auto now = std::chrono::steady_clock::now();
    if (now - current_request->last_poll < kPollInterval) return;
    current_request->last_poll = now;
    try {
        if (current_request->is_over()) throw Cancelled();
    } catch (...) {
        current_request->cause = std::current_exception();
        current_request->is_cancelled.store(true, std::memory_order_release);
        throw;
    }
}

CancelHandover::CancelHandover() : request_(current_request) {}
void CancelHandover::take_over() const { current_request = request_; }

}  // namespace brushsvg
