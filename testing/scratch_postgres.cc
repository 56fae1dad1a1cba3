#include "testing/scratch_postgres.h"

#include <array>
#include <memory>

#include <fcntl.h>
#include <libpq-fe.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace victorious::testing {
namespace {

constexpr int kNotInstalled = 77;

}  // namespace

// The script serves until its standard input ends: at the end of this process, however that comes.
ScratchPostgres::ScratchPostgres(const std::vector<std::string>& settings) {
  std::array<int, 2> input{};
  std::array<int, 2> output{};
  if (::pipe2(input.data(), O_CLOEXEC) != 0 || ::pipe2(output.data(), O_CLOEXEC) != 0) {
    url_ = std::unexpected(ErrorFromErrno(errno, "a pipe to the server"));
    return;
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output[1], STDOUT_FILENO);
  std::vector<std::string> words = {VICTORIOUS_SOURCE_DIR "/tools/scratch_postgres.sh"};
  words.insert(words.end(), settings.begin(), settings.end());
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int fault = ::posix_spawn(&process_, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(input[0]);
  ::close(output[1]);
  input_ = input[1];
  if (fault != 0) {
    process_ = -1;
    url_ = std::unexpected(ErrorFromErrno(fault, words[0]));
  } else {
    url_ = ReadUrl(output[0]);
  }
  ::close(output[0]);
}

Expected<std::string> ScratchPostgres::ReadUrl(int output) {
  std::string line;
  for (char c = 0; ::read(output, &c, 1) == 1 && c != '\n';) line += c;
  if (line.starts_with("postgresql://")) return line;
  const int status = Stop();
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotInstalled) return Fail(ErrorCode::kUnsupported, line);
  return Fail(ErrorCode::kInternal, "tools/scratch_postgres.sh failed: its reason is on standard error");
}

int ScratchPostgres::Stop() {
  int status = 0;
  ::close(std::exchange(input_, -1));
  if (process_ > 0) ::waitpid(std::exchange(process_, -1), &status, 0);
  return status;
}

Expected<std::string> EmptyPostgresDatabase() {
  static const ScratchPostgres server;
  if (!server.url()) return server.url();
  const std::unique_ptr<PGconn, decltype(&PQfinish)> connection(PQconnectdb(server.url()->c_str()), &PQfinish);
  // Connections that a failed test left would keep its locks.
  const std::unique_ptr<PGresult, decltype(&PQclear)> result(
      PQexec(
          connection.get(),
          "SET client_min_messages = warning; SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = "
          "current_database() AND pid <> pg_backend_pid(); DROP SCHEMA IF EXISTS victorious CASCADE"),
      &PQclear);
  if (PQresultStatus(result.get()) == PGRES_COMMAND_OK) return server.url();
  return Fail(ErrorCode::kInternal, PQerrorMessage(connection.get()));
}

}  // namespace victorious::testing
