// The reader of daylighting tables: its recognition.
#pragma once
#include <string_view>

namespace srbf {

bool is_xml(std::string_view text);

}  // namespace srbf
