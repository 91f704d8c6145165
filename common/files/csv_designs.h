// Items and materials of tables. Private to the files that read designs.
#pragma once

#include "common/files/csv_table.h"
#include "common/files/design_file.h"

namespace mortise::parametric {

// `table` has at least one row. Its own findings are not told again.
DesignFile ItemsOfTable(const CsvTable& table);
DesignFile MaterialsOfTable(const CsvTable& table);

}  // namespace mortise::parametric
