// Private to mesh/: a glTF 2.0 file (.gltf or .glb) as JSON with its buffers; numbers of accessors as floating point.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "victorious/object/mesh/cad_folder.h"

namespace victorious {

/// The numbers of an accessor.
struct AccessorValues {
  std::size_t components = 0;  ///< of one element: 3 of a VEC3, 16 of a MAT4
  std::vector<double> values;  ///< element by element; normalised integers are divided by their range

  [[nodiscard]] std::size_t count() const { return components == 0 ? 0 : values.size() / components; }
};

class GltfFile {
 public:
  /// std::nullopt if it is not glTF 2.0, or damaged: the importer says what is wrong.
  /// @param folder  must outlive it
  [[nodiscard]] static std::optional<GltfFile> Read(const CadFolder& folder);
  GltfFile(GltfFile&&) noexcept;
  ~GltfFile();

  nlohmann::json& document() { return *document_; }
  [[nodiscard]] const nlohmann::json& document() const { return *document_; }

  /// An element of one of the file's lists ("nodes", "meshes", …); null if it is not there.
  [[nodiscard]] nlohmann::json* Find(std::string_view list, const nlohmann::json& index);

  /// std::nullopt for accessors that are damaged, sparse or compressed.
  [[nodiscard]] std::optional<AccessorValues> ReadAccessor(const nlohmann::json& index);

  /// True if the numbers are integers, or there is no such accessor.
  [[nodiscard]] bool IsFloat(const nlohmann::json& index);

  /// Adds numbers as an accessor of floats. Returns its index.
  /// @param values  of 1 to 4 components
  std::size_t AddAccessor(const AccessorValues& values);

  /// The file with what was changed and added.
  [[nodiscard]] std::string Write() const;

 private:
  explicit GltfFile(const CadFolder& folder);

  [[nodiscard]] const std::string* ReadBuffer(std::size_t index);

  const CadFolder* folder_;
  std::unique_ptr<nlohmann::json> document_;
  std::optional<std::string> binary_;  // the second chunk of a .glb
  bool is_glb_ = false;
  std::map<std::size_t, std::string> buffers_;  // those that were read
  std::string added_;                           // bytes of the added accessors
};

}  // namespace victorious
