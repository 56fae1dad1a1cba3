#include "victorious/input/video/tls_verification.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "victorious/base/absolute_path.h"
#include "victorious/base/file.h"
#include "victorious/base/one_line.h"
#include "victorious/input/video/ffmpeg_handles.h"
#include "victorious/input/video/trusted_certificates.h"

extern "C" {
#include <libavutil/log.h>
#include <libavutil/opt.h>
}

namespace victorious {
namespace {

std::filesystem::path& TrustedFile() {
  static std::filesystem::path file;
  return file;
}

thread_local std::string tls_fault;

// Calls `change` with each option of FFmpeg's protocol "tls" of one of these names. Its options are constants: their
// pages are made writable, and left so, because other variables may lie there.
// @return false if there is none, or it cannot be written
template <typename Change>
bool ChangeTlsOptions(std::initializer_list<std::string_view> names, Change change) {
  const AVClass* const of_tls = avio_protocol_get_class("tls");
  if (of_tls == nullptr) return false;
  bool is_changed = false;
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  for (const AVOption* option = nullptr; (option = av_opt_next(&of_tls, option)) != nullptr;) {
    if (std::ranges::find(names, std::string_view(option->name)) == names.end()) continue;
    const auto begin = reinterpret_cast<std::uintptr_t>(option) / page * page;
    const auto end = reinterpret_cast<std::uintptr_t>(option + 1);
    if (::mprotect(reinterpret_cast<void*>(begin), end - begin, PROT_READ | PROT_WRITE) != 0) return false;
    change(const_cast<AVOption&>(*option));  // NOLINT: see above
    is_changed = true;
  }
  return is_changed;
}

}  // namespace

bool VerifyCertificates() {
  static const bool verifies = ChangeTlsOptions({"tls_verify"}, [](AVOption& option) { option.default_val.i64 = 1; });
  return verifies;
}

Status CheckVerifies(std::string_view scheme, const std::string& url) {
  const bool is_encrypted = scheme == "rtsps" || scheme == "https" || scheme == "rtmps";
  if (!is_encrypted || VerifyCertificates()) return {};
  return Fail(ErrorCode::kUnsupported,
              fmt::format("{}: this build of FFmpeg does not let certificates be verified: use one with GnuTLS, as "
                          "Debian ships it",
                          url));
}

void KeepTlsFault(void* object, int level, const char* format, std::va_list arguments) {
  if (level > AV_LOG_ERROR || object == nullptr) return;
  const AVClass* const of_object = *static_cast<const AVClass* const*>(object);
  if (of_object == nullptr || of_object->item_name == nullptr) return;
  if (std::string_view(of_object->item_name(object)) != "tls") return;
  std::array<char, 500> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  tls_fault = text.data();
  while (tls_fault.ends_with('\n')) tls_fault.pop_back();
}

// FFmpeg's words are never translated.
std::string TakeTlsFault() {
  const std::string fault = OneLine(std::exchange(tls_fault, {}));
  if (fault.empty()) return "";
  if (fault.starts_with("Peer certificate failed")) {
    return "the certificate of the server is not trusted: give --ca FILE with the certificate of the authority that "
           "issued it";
  }
  if (fault.starts_with("The certificate's owner")) {
    return "the certificate of the server is one of another host: use the host name that the certificate has";
  }
  return fmt::format("no encrypted connection ({}): check the server's TLS", fault);
}

Status TrustCertificates(const std::filesystem::path& file) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(file));
  if (!text.contains("-----BEGIN CERTIFICATE-----") && !text.contains("-----BEGIN TRUSTED CERTIFICATE-----")) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("--ca {}: no certificate in it: give a file of certificates (PEM)", OneLine(file.string())));
  }
  TrustedFile() = AbsolutePath(file);
  // Read by FFmpeg as long as the process lives. Of both names of the option the last one counts.
  static std::string path;
  path = TrustedFile().string();
  const auto name_file = [](AVOption& option) { option.default_val.str = path.c_str(); };
  if (ChangeTlsOptions({"ca_file", "cafile"}, name_file)) return {};
  return Fail(ErrorCode::kUnsupported, "--ca: this build of FFmpeg does not let certificates be named");
}

const std::filesystem::path& TrustedCertificates() { return TrustedFile(); }

}  // namespace victorious
