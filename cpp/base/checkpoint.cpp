#include "brushsvg/checkpoint.hpp"

#include <atomic>
#include <chrono>
#include <exception>
#include <thread>
#include <utility>

namespace brushsvg {

struct CancelWhen::Asked {
    std::function<bool()> is_over;
    std::thread::id owner = std::this_thread::get_id();
    std::chrono::steady_clock::time_point last{};
    std::exception_ptr why;
    std::atomic<bool> over{false};  ///< cancelled, for the reason in `why`
};

namespace {

/// Amount of work between readings of the clock, and time between calls of is_over.
constexpr int kWorkBetween = 500;
constexpr std::chrono::milliseconds kBetween{50};

thread_local CancelWhen::Asked* asked = nullptr;
thread_local int done = 0;

}  // namespace

CancelWhen::CancelWhen(std::function<bool()> is_over) : asked_(std::make_unique<Asked>()), before_(asked) {
    asked_->is_over = std::move(is_over);
    asked = asked_.get();
}

CancelWhen::~CancelWhen() { asked = before_; }

void checkpoint(int work) {
    if (!asked) return;
    if (asked->over.load(std::memory_order_acquire)) std::rethrow_exception(asked->why);
    if (asked->owner != std::this_thread::get_id() || (done += work) < kWorkBetween) return;
    done = 0;
    const auto now = std::chrono::steady_clock::now();
    if (now - asked->last < kBetween) return;
    asked->last = now;
    try {
        if (asked->is_over()) throw Cancelled();
    } catch (...) {
        asked->why = std::current_exception();
        asked->over.store(true, std::memory_order_release);
        throw;
    }
}

SameCancel::SameCancel() : asked_(asked) {}
void SameCancel::take_over() const { asked = asked_; }

}  // namespace brushsvg
