// Each allocation of each reader fails in turn: the reader gives up, and nothing leaks or is freed twice, which
// sanitizers see. This program has its own operator new.
#include <new>

#include "../fuzz/targets.h"
#include "corpus.h"
#include "properties.h"
#include "srbf/load.h"

namespace {

std::size_t allocations = 0, fails_at = std::size_t(-1);

void* allocated(std::size_t size, std::size_t alignment) {
    if (allocations++ == fails_at) throw std::bad_alloc();
    void* const memory = alignment > alignof(std::max_align_t)
                             ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                             : std::malloc(size > 0 ? size : 1);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(std::size_t size) { return allocated(size, 1); }
void* operator new(std::size_t size, std::align_val_t alignment) { return allocated(size, std::size_t(alignment)); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace srbf::allocations_test {
namespace {

/// Makes allocation number `index` of `action` fail. Returns true if it makes so many.
template <typename Action> bool is_failed(std::size_t index, const Action& action) {
    allocations = 0;
    fails_at = index;
    action();
    fails_at = std::size_t(-1);
    return allocations > index;
}

/// Trying every allocation takes quadratic time: after the first k_tried, only every k_step-th fails, up to k_last.
constexpr std::size_t k_tried = 60, k_step = 127, k_last = 3000;

TEST(Allocations, FailuresEndAReader) {
    const auto corpus = corpus_files();
    for (const NamedTarget& target : all_targets()) {
        for (const std::string& bytes : corpus.at(target.name)) {
            const auto file = std::as_bytes(std::span(bytes));
            const auto read = [&] {
                try {
#ifdef SRBF_RENDER
                    // The input is only read, because the functions that draw a mesh have destructors that allocate
                    // too.
                    if (target.name == "ply")
                        (void)bool(read_ply(file, "f"));
                    else if (target.name == "obj")
                        (void)bool(read_obj(file, "f"));
                    else
#endif
                        target.check(file);
                } catch (const std::bad_alloc&) {
                }
            };
            for (std::size_t i = 0; i < k_last && is_failed(i, read); i += i < k_tried ? 1 : k_step) continue;
        }
    }
}

TEST(Allocations, ABlackBrdfMakesNone) {
    allocations = 0;
    const PreparedBrdf black, copy = black;
    const float weight = sample(copy, {0, 0, 1}, {0.5f, 0.5f}, 0.5f).weight.g,
                density = pdf(copy, {0, 0, 1}, {0, 0, 1});
    const float reflected = value(copy, {0, 0, 1}, {0, 0, 1}).g + albedo(copy, 1).g;
    EXPECT_EQ(allocations, 0u);
    EXPECT_EQ(weight + density + reflected, 0);
}

TEST(Allocations, FailuresAreErrorsThatNameTheFile) {
    for (const char* name :
         {"measured/rgl_simple", "measured/csv_vectors", "measured/merl_small", "measured/csv_both_sides"}) {
        const std::string path = std::string(SRBF_SOURCE_DIR "/fuzz/corpus/") + name;
        int errors = 0;
        const auto load = [&] {
            const auto loaded = load_brdf(path);
            if (loaded) return;
            EXPECT_EQ(loaded.error().source, path);
            EXPECT_EQ(loaded.error().what, "out of memory");
            ++errors;
        };
        for (std::size_t i = 0; is_failed(i, load); ++i) continue;
        EXPECT_GE(errors, 3) << name;
    }
}

}  // namespace
}  // namespace srbf::allocations_test
