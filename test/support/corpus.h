// The small files that fuzzers begin with: fuzz/corpus/TARGET/ and extras/NAME/corpus/TARGET/.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "temporary_folder.h"

namespace srbf {

/// Folders of each target.
inline std::map<std::string, std::filesystem::path> corpora() {
    namespace fs = std::filesystem;
    const fs::path root(SRBF_SOURCE_DIR);
    std::map<std::string, fs::path> all;
    const auto add = [&](const fs::path& corpus) {
        if (!fs::exists(corpus)) return;
        for (const auto& entry : fs::directory_iterator(corpus)) all[entry.path().filename().string()] = entry.path();
    };
    add(root / "fuzz" / "corpus");
    for (const auto& extra : fs::directory_iterator(root / "extras")) add(extra.path() / "corpus");
    return all;
}

/// The contents of the files of each target.
inline std::map<std::string, std::vector<std::string>> corpus_files() {
    std::map<std::string, std::vector<std::string>> files;
    for (const auto& [target, folder] : corpora())
        for (const auto& file : std::filesystem::directory_iterator(folder))
            files[target].push_back(read_text(file.path()));
    return files;
}

}  // namespace srbf
