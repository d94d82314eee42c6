#pragma once

#include <exception>
#include <functional>
#include <memory>

namespace [[gnu::visibility("default")]] brushsvg {

/// Thrown out of what was running when it is to be given up.
class Cancelled : public std::exception {
 public:
    const char* what() const noexcept override { return "cancelled"; }
};

/// While one lives, long work of this thread, and of those that it starts for it, asks it several times a second
/// whether to go on:
///
///     std::atomic<bool> stop{false};  // set by a button
///     const CancelWhen cancel([&] { return stop.load(); });
///     compensate(stroke, brush);      // throws Cancelled soon after
///
/// `is_over` is called on this thread only. What it throws itself ends the work, too. The innermost one counts.
class CancelWhen {
 public:
    explicit CancelWhen(std::function<bool()> is_over);
    ~CancelWhen();
    CancelWhen(const CancelWhen&) = delete;
    CancelWhen& operator=(const CancelWhen&) = delete;

    struct Asked;

 private:
    std::unique_ptr<Asked> asked_;
    Asked* before_;
};

/// What loops call. `work`: how much was done since the last call, in microseconds or so.
void checkpoint(int work = 1);

/// Hands this thread's CancelWhen on to threads that work for it.
class SameCancel {
 public:
    SameCancel();
    /// Called on the other thread, which must end before this thread goes on.
    void take_over() const;

 private:
    CancelWhen::Asked* asked_;
};

}  // namespace brushsvg
