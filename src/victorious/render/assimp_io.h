// Private to render/: assimp's view of a CadFolder.
#pragma once

#include <assimp/IOSystem.hpp>

#include "victorious/render/cad_folder.h"

namespace victorious {

/// Read-only; every file is read whole when it is opened. `folder` must outlive it.
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
