// Parsing tensor trees. Private to the reader of BSDF XML.
#pragma once
#include <string_view>

#include "measured/tables.h"
#include "srbf/daylight.h"

namespace SRBF_NAMESPACE {

template <typename Each> void members(TensorTree& value, const Each& each) {
    each(value.rank);
    each(value.root);
    each(value.nodes);
    each(value.leaves);
}
template <typename Each> void members(TreeTable& value, const Each& each) {
    each(value.y);
    each(value.chromaticity);
}

std::vector<TableLine> lines_about(const TreeTable& table);

/// Upper bound on the memory [bytes] of a tree with this text.
std::size_t max_tree_bytes(std::string_view text);
/// Reads a tree of rank 3 or 4: braces that enclose 2^rank trees or 2^(rank k) numbers, separated by white space or
/// commas. An error has the byte offset in `text`, and no source.
Result<TensorTree> read_tensor_tree(std::string_view text, int rank);

}  // namespace
