// The two types of srbf.h as the compiler needs them. Programs include srbf.h, and need no other name of this header.
#pragma once
#include <cassert>
#include <cstring>
#include <limits>
#include <utility>

#include "srbf/vec.h"
#include "srbf/version.h"

SRBF_BEGIN

/// Refers to a T, which is destroyed with the last of the copies, or to none by default: a std::shared_ptr<const T> for
/// headers that are compiled often, since <memory> takes longer than they do. The type T counts: it is made with one
/// use, and `add_use(const T&)` and `end_use(const T&)`, which any thread may call, count and destroy it. A move is a
/// copy, so that a `Shared` that was moved from still refers to its T.
template <typename T> class Shared {
  public:
    Shared() = default;
    explicit Shared(const T* object) : object_(object) {}
    Shared(const Shared& other) noexcept : object_(other.object_) {
        if (object_) add_use(*object_);
    }
    Shared& operator=(Shared other) noexcept { return std::swap(object_, other.object_), *this; }
    ~Shared() {
        if (object_) end_use(*object_);
    }
    explicit operator bool() const { return object_ != nullptr; }
    const T& operator*() const { return *object_; }
    const T* operator->() const { return object_; }

  private:
    const T* object_ = nullptr;
};

/// True if both directions are above the horizon: every component is finite, and z is at least the least normal float,
/// whether the processor takes subnormal numbers for 0 or not.
inline bool above_horizon(const Vec3f& wl, const Vec3f& wv) {
    constexpr float min = std::numeric_limits<float>::min();
    return wl.z >= min && wv.z >= min && is_finite({wl.x, wl.y, wl.z}) && is_finite({wv.x, wv.y, wv.z});
}

/// True unless a direction of a pair above the horizon has another length than 1, by more than half a per cent. Debug
/// builds assert it.
inline bool has_unit_lengths(const Vec3f& wl, const Vec3f& wv) {
    return !above_horizon(wl, wv) || (std::abs(dot(wl, wl) - 1) < 0.01f && std::abs(dot(wv, wv) - 1) < 0.01f);
}

/// A measurement or a fitted model. load.h has its content, which copies share. By default it has none: it can be
/// copied and assigned then, and a function that reads it ends the program with a line and abort().
struct LoadedBrdf {
    struct Contents;
    Shared<Contents> contents;
};

/// A BRDF ready for a renderer, which `prepare` makes. Copies share its contents. By default it is black and allocates
/// nothing: `value`, `evaluate`, `pdf` and `albedo` are 0, and no sample has a direction.
class PreparedBrdf {
  public:
    /// Writes R, G, B of f_r and one unused number to `colour`, which is aligned to 16 bytes.
    using Value = void (*)(const void* brdf, const Vec3f& wl, const Vec3f& wv, float* colour);
    struct Contents;  ///< Value and the rest for one type of BRDF
    PreparedBrdf() = default;
    explicit PreparedBrdf(Shared<Contents> contents);

    const Contents& contents() const;
    /// The `value` of srbf.h.
    Rgb at(const Vec3f& wl, const Vec3f& wv) const {
        assert(has_unit_lengths(wl, wv));
        if (!above_horizon(wl, wv)) return {};
        alignas(16) float colour[4];
        value_(held_, wl, wv, colour);
        Rgb f;
        std::memcpy(&f, colour, sizeof f);  // the stored bytes
        return f;
    }

  private:
    Shared<Contents> contents_;
    // The BRDF itself and its function, both of the contents.
    const void* held_ = nullptr;
    Value value_ = [](const void*, const Vec3f&, const Vec3f&, float* colour) {
        for (int c = 0; c < 4; ++c) colour[c] = 0;
    };
};

// Count the copies that share contents; Shared calls them.
void add_use(const LoadedBrdf::Contents& contents);
void end_use(const LoadedBrdf::Contents& contents);
void add_use(const PreparedBrdf::Contents& contents);
void end_use(const PreparedBrdf::Contents& contents);

SRBF_END
