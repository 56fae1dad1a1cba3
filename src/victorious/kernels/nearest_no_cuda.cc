// In builds without VICTORIOUS_CUDA.
#include "victorious/kernels/nearest_device.h"

namespace victorious::kernels {

std::shared_ptr<NearestDevice> OpenNearestDevice(std::string& why_not) {
  why_not = "this program was built without CUDA (cmake --preset cuda)";
  return nullptr;
}

}  // namespace victorious::kernels
