// Matrices and trees as tables of a BSDF's parts.
#include <fmt/format.h>

#include "base/printable.h"
#include "extras/daylight/formats.h"
#include "extras/daylight/klems.h"
#include "extras/daylight/tensor_tree.h"
#include "extras/daylight/tree_beam.h"
#include "measured/tables.h"

namespace SRBF_NAMESPACE {

bool is_isotropic(const TreeTable& table) { return table.y.rank == 3; }

std::vector<TableLine> lines_about(const KlemsTable& table) {
    return {{"patches", fmt::format("{} outgoing ({}) × {} incident ({})", table.outgoing.patches(),
                                    table.outgoing.name, table.incident.patches(), table.incident.name)},
            {"value [1/sr]", {}, table.cells}};
}

std::vector<TableLine> lines_about(const TreeTable& table) {
    ValueRange range;
    for (const float f : table.y.leaves) range.add(f);
    return {{"tensor tree",
             fmt::format("rank {}, {} leaves of {:g} at least, {}", table.y.rank, grouped(table.y.leaves.size()),
                         table.y.smallest_leaf(), table.chromaticity.empty() ? "grey" : "in colour")},
            {"value [1/sr]", range.text()}};
}

EvaluatedTable as_evaluated_table(KlemsTable matrix) {
    return evaluated_table(std::make_shared<const KlemsTable>(std::move(matrix)));
}

EvaluatedTable as_evaluated_table(TreeTable tree) {
    const auto table = std::make_shared<const TreeTable>(std::move(tree));
    TableFunctions functions;
    functions.separated_beam = [table] { return separated_beam(table); };
    return evaluated_table(table, std::move(functions));
}

}  // namespace
