// Private to mesh/: adapter from assimp's file interface (Assimp::IOSystem) to a CadFolder.
#pragma once

#include <assimp/IOSystem.hpp>

#include "victorious/object/mesh/cad_folder.h"

namespace victorious {

/// Read-only. Open() reads the whole file into memory. `folder` must outlive this object.
class CadFolderIo : public Assimp::IOSystem {
 public:
  explicit CadFolderIo(const CadFolder& folder) : folder_(folder) {}

  bool Exists(const char* name) const override;
  [[nodiscard]] char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

 private:
  const CadFolder& folder_;
};

}  // namespace victorious
