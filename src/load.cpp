#include "srbf/load.h"

#include "srbf/file.h"

namespace srbf {

Result<AnyBrdf> load_brdf(const std::string& path) {
    auto bytes = read_file(path);
    if (!bytes) return bytes.error();
    if (is_safetensors(*bytes)) {
        auto model = read_model(*bytes, path);
        if (!model) return model.error();
        return AnyBrdf(*std::move(model));
    }
    auto measured = read_measured(*std::move(bytes), path);
    if (!measured) return measured.error();
    return AnyBrdf(*std::move(measured));
}

}  // namespace srbf
