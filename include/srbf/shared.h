// A value that its copies share.
#pragma once
#include <utility>

namespace [[gnu::visibility("default")]] srbf {

/// Refers to a T, which is destroyed with the last of the copies: a std::shared_ptr<const T> for headers that are compiled
/// often, since <memory> takes longer than they do. The type T counts: it is made with one use, and
/// `add_use(const T&)` and `end_use(const T&)`, which any thread may call, count and destroy it. A `Shared` that was moved
/// from can only be assigned to or destroyed.
template <typename T> class Shared {
  public:
    explicit Shared(const T* of) : of_(of) {}
    Shared(const Shared& other) : of_(other.of_) { add_use(*of_); }
    Shared(Shared&& other) noexcept : of_(std::exchange(other.of_, nullptr)) {}
    Shared& operator=(Shared other) noexcept { return std::swap(of_, other.of_), *this; }
    ~Shared() {
        if (of_) end_use(*of_);
    }
    const T& operator*() const { return *of_; }
    const T* operator->() const { return of_; }

  private:
    const T* of_;
};

}  // namespace srbf
