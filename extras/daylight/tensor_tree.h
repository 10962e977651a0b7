// The text of tensor trees: private to the reader of BSDF XML.
#pragma once
#include <string_view>

#include "srbf/daylight.h"

namespace srbf {

template <typename Each> void members(TensorTree& of, const Each& each) {
    each(of.rank), each(of.root), each(of.nodes), each(of.leaves);
}
template <typename Each> void members(TreeTable& of, const Each& each) { each(of.y), each(of.chromaticity); }

std::vector<TableLine> lines_about(const TreeTable& table);

/// Bytes that a tree of this text takes in memory at most.
std::size_t most_tree_bytes(std::string_view text);
/// Reads a tree of rank 3 or 4: `{` with 2^rank trees within, or `{` with 2^(rank k) numbers, separated by white space or
/// commas. The error states the byte of `text` by its offset, and has no source.
Result<TensorTree> read_tensor_tree(std::string_view text, int rank);

}  // namespace srbf
