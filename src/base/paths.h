// Paths of the standard library from texts of UTF-8, and back, which need a conversion on Windows.
#pragma once
#include <filesystem>
#include <string>

namespace SRBF_NAMESPACE::system_files {

#ifdef _WIN32
inline std::filesystem::path path_of(const std::string& path) { return {std::u8string(path.begin(), path.end())}; }
inline std::string path_text(const std::filesystem::path& path) {
    const std::u8string text = path.u8string();
    return {text.begin(), text.end()};
}
#else
inline std::filesystem::path path_of(const std::string& path) { return path; }
inline std::string path_text(const std::filesystem::path& path) { return path.string(); }
#endif

/// A file's name without its folder and its last ending.
inline std::string stem(const std::string& path) { return path_text(path_of(path).stem()); }

}  // namespace srbf::system_files
