// A value that its copies share.
#pragma once
#include <utility>

#include "srbf/version.h"

SRBF_BEGIN

/// Refers to a T, which is destroyed with the last of the copies, or to none by default: a std::shared_ptr<const T> for
/// headers that are compiled often, since <memory> takes longer than they do. The type T counts: it is made with one use,
/// and `add_use(const T&)` and `end_use(const T&)`, which any thread may call, count and destroy it. A move is a copy, so
/// that a `Shared` that was moved from still refers to its T.
template <typename T> class Shared {
  public:
    Shared() = default;
    explicit Shared(const T* of) : of_(of) {}
    Shared(const Shared& other) noexcept : of_(other.of_) {
        if (of_) add_use(*of_);
    }
    Shared& operator=(Shared other) noexcept { return std::swap(of_, other.of_), *this; }
    ~Shared() {
        if (of_) end_use(*of_);
    }
    explicit operator bool() const { return of_ != nullptr; }
    const T& operator*() const { return *of_; }
    const T* operator->() const { return of_; }

  private:
    const T* of_ = nullptr;
};

SRBF_END
