#pragma once

#include <exception>
#include <functional>
#include <memory>

namespace [[gnu::visibility("default")]] brushsvg {

/// Thrown by long work when it is cancelled.
class Cancelled : public std::exception {
 public:
    const char* what() const noexcept override { return "cancelled"; }
};

/// Cancels long work on this thread while the object lives.
///
/// Threads that the work starts are cancelled as well. The work calls `is_over` several times a second and stops when
/// it returns true:
///
///     std::atomic<bool> stop{false};  // set by a button
///     const CancelWhen cancel([&] { return stop.load(); });
///     compensate(stroke, brush);      // throws Cancelled soon after
///
/// `is_over` is called on this thread only. An exception that it throws ends the work as well. If there are several
/// objects, the innermost one counts.
class CancelWhen {
 public:
    explicit CancelWhen(std::function<bool()> is_over);
    ~CancelWhen();
    CancelWhen(const CancelWhen&) = delete;
    CancelWhen& operator=(const CancelWhen&) = delete;

    struct CancelRequest;

 private:
    std::unique_ptr<CancelRequest> request_;
    CancelRequest* outer_;
};

/// Check whether the work is cancelled, and throw if it is. Long loops call this function.
///
/// `work`: how much was done since the last call, roughly in microseconds.
void checkpoint(int work = 1);

/// Passes this thread's CancelWhen on to threads that work for it.
class CancelHandover {
 public:
    CancelHandover();
    /// Use the CancelWhen on the other thread. That thread must end before the first thread goes on.
    void take_over() const;

 private:
    CancelWhen::CancelRequest* request_;
};

}  // namespace brushsvg
