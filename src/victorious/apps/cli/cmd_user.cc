// victorious user add | change | remove | list | token | revoke | log: who may use `victorious serve`
#include <array>
#include <csignal>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/serve/secret.h"
#include "victorious/base/json.h"
#include "victorious/base/utc.h"
#include "victorious/store/account_store.h"
#include "victorious/store/open_store.h"
#include "victorious/types/json_values.h"

namespace victorious::cli {
namespace {

constexpr std::int64_t kDay = 86'400'000'000;

struct UserArguments {
  std::string db;
  std::string name;
  std::string role;
  bool has_new_password = false;
  std::string label;
  int days = 365;
  std::int64_t token = 0;
  std::int64_t limit = 100;
  bool json = false;
};

Expected<std::unique_ptr<AccountStore>> Open(const UserArguments& arguments, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(const bool has_index, HasIndex(arguments.db));
  if (!has_index) return Fail(ErrorCode::kNotFound, fmt::format("{}: no such index", StoreName(arguments.db)));
  return OpenAccountStore(arguments.db, mode);
}

// The signal that came while typing was hidden, or 0.
volatile std::sig_atomic_t g_interrupted_by = 0;

// What is typed is not shown. A signal that ends or stops the program ends the wait for a line and takes effect once
// the terminal shows what is typed again. It can only come during that wait: one that came before it would be lost.
class HiddenInput {
 public:
  HiddenInput() : is_terminal_(::tcgetattr(STDIN_FILENO, &former_) == 0) {
    if (!is_terminal_) return;
    g_interrupted_by = 0;
    sigset_t signals;
    ::sigemptyset(&signals);
    for (const int signal : kSignals) ::sigaddset(&signals, signal);
    ::pthread_sigmask(SIG_BLOCK, &signals, &former_mask_);
    struct sigaction action{};
    action.sa_handler = [](int signal) { g_interrupted_by = signal; };
    for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &action, &former_actions_[i]);
    termios hidden = former_;
    hidden.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &hidden);
  }
  ~HiddenInput() {
    if (!is_terminal_) return;
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &former_);
    for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &former_actions_[i], nullptr);
    if (g_interrupted_by != 0) std::raise(g_interrupted_by);
    ::pthread_sigmask(SIG_SETMASK, &former_mask_, nullptr);
  }
  HiddenInput(const HiddenInput&) = delete;
  HiddenInput& operator=(const HiddenInput&) = delete;

  [[nodiscard]] bool is_terminal() const { return is_terminal_; }

  /// Waits for a line on the terminal. Returns false if a signal came first.
  [[nodiscard]] bool WaitForLine() const {
    pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    return ::ppoll(&input, 1, nullptr, &former_mask_) > 0;
  }

 private:
  static constexpr std::array<int, 5> kSignals = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP};

  termios former_{};
  sigset_t former_mask_{};
  std::array<struct sigaction, kSignals.size()> former_actions_{};
  bool is_terminal_;
};

Expected<std::string> ReadLine(std::string_view prompt, const HiddenInput& hidden) {
  if (hidden.is_terminal()) std::cerr << prompt << std::flush;
  std::string line;
  const bool may_read = !hidden.is_terminal() || hidden.WaitForLine();
  const bool has_line = may_read && static_cast<bool>(std::getline(std::cin, line));
  if (hidden.is_terminal()) std::cerr << '\n';
  if (has_line) return line;
  return Fail(ErrorCode::kInvalidArgument, "no password on standard input: give it there as one line");
}

// From the terminal twice, else one line of standard input. Never an argument, which every user of the machine sees.
Expected<std::string> ReadPassword() {
  const HiddenInput hidden;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string password, ReadLine("Password: ", hidden));
  VICTORIOUS_RETURN_IF_ERROR(CheckPassword(password));
  if (hidden.is_terminal()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string again, ReadLine("Once more: ", hidden));
    if (again != password) return Fail(ErrorCode::kInvalidArgument, "the two passwords differ: give the same twice");
  }
  return password;
}

Expected<Account> FindAccount(AccountStore& accounts, const UserArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Account> account, accounts.Find(arguments.name));
  if (account) return *account;
  return Fail(ErrorCode::kNotFound, fmt::format("{}: there is no account {}: `victorious user list` lists them",
                                                StoreName(arguments.db), arguments.name));
}

// Changes of accounts are in the log. No account has this actor's name, which has a space.
AuditRecord EntryOf(const UserArguments& arguments, const char* action, const Json& detail) {
  return {.time_utc_us = NowUtcMicroseconds(),
          .actor = "victorious user",
          .action = action,
          .subject = "account " + arguments.name,
          .detail = DumpJson(detail)};
}

// An account with its tokens, without their secrets.
Expected<Json> RowOf(const Account& account, AccountStore& accounts) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Credential> tokens, accounts.Tokens(account.id));
  Json rows = Json::array();
  for (const Credential& token : tokens)
    rows.push_back({{"id", token.id}, {"label", token.label}, {"expires", FormatUtc(token.expires_utc_us)}});
  return Json({{"name", account.name},
               {"role", ToText(account.role)},
               {"created", FormatUtc(account.created_utc_us)},
               {"tokens", std::move(rows)}});
}

// With --json, the account as a change left it.
Status PrintChanged(const Status& changed, const UserArguments& arguments, AccountStore& accounts) {
  if (!changed || !arguments.json) return changed;
  VICTORIOUS_ASSIGN_OR_RETURN(const Account account, FindAccount(accounts, arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const Json row, RowOf(account, accounts));
  return WriteOutput("", DumpJson(row) + "\n");
}

Status Add(const UserArguments& arguments) {
  VICTORIOUS_RETURN_IF_ERROR(CheckAccountName(arguments.name));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto accounts, Open(arguments, StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Account> known, accounts->Find(arguments.name));
  if (known) {
    return Fail(ErrorCode::kAlreadyExists, fmt::format("{}: there is an account {} already: `victorious user change` "
                                                       "changes it",
                                                       StoreName(arguments.db), known->name));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string password, ReadPassword());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string hash, HashPassword(password));
  const Status added = accounts->ChangeAndLog([&]() -> Expected<AuditRecord> {
    VICTORIOUS_RETURN_IF_ERROR(
        accounts->Add(arguments.name, *FromText(kRoleTexts, arguments.role), hash, NowUtcMicroseconds()));
    return EntryOf(arguments, "add_account", {{"role", arguments.role}});
  });
  return PrintChanged(added, arguments, *accounts);
}

Status Change(const UserArguments& arguments) {
  if (arguments.role.empty() && !arguments.has_new_password) {
    return Fail(ErrorCode::kInvalidArgument, "give --role, --password or both: what is to be changed");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto accounts, Open(arguments, StoreMode::kCreate));
  VICTORIOUS_RETURN_IF_ERROR(FindAccount(*accounts, arguments));
  if (arguments.has_new_password) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string password, ReadPassword());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string hash, HashPassword(password));
    const Status renewed = accounts->ChangeAndLog([&]() -> Expected<AuditRecord> {
      VICTORIOUS_RETURN_IF_ERROR(accounts->SetPassword(arguments.name, hash));
      return EntryOf(arguments, "change_password", Json::object());
    });
    VICTORIOUS_RETURN_IF_ERROR(renewed);
  }
  Status changed;
  if (!arguments.role.empty()) {
    changed = accounts->ChangeAndLog([&]() -> Expected<AuditRecord> {
      VICTORIOUS_RETURN_IF_ERROR(accounts->SetRole(arguments.name, *FromText(kRoleTexts, arguments.role)));
      return EntryOf(arguments, "change_role", {{"role", arguments.role}});
    });
  }
  return PrintChanged(changed, arguments, *accounts);
}

Status Remove(const UserArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto accounts, Open(arguments, StoreMode::kCreate));
  const Status removed = accounts->ChangeAndLog([&]() -> Expected<AuditRecord> {
    VICTORIOUS_RETURN_IF_ERROR(accounts->Remove(arguments.name));
    return EntryOf(arguments, "remove_account", Json::object());
  });
  if (!removed || !arguments.json) return removed;
  return WriteOutput("", DumpJson(Json({{"removed", arguments.name}})) + "\n");
}

Status List(const UserArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto accounts, Open(arguments, StoreMode::kRead));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Account> all, accounts->Accounts());
  std::string text;
  for (const Account& account : all) {
    if (arguments.json) {
      VICTORIOUS_ASSIGN_OR_RETURN(const Json row, RowOf(account, *accounts));
      text += DumpJson(row) + "\n";
      continue;
    }
    text +=
        fmt::format("{:<24} {:<8} since {}\n", account.name, ToText(account.role), FormatUtc(account.created_utc_us));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Credential> tokens, accounts->Tokens(account.id));
    for (const Credential& token : tokens)
      text +=
          fmt::format("  token {} ({}) until {}\n", token.id, OneLine(token.label), FormatUtc(token.expires_utc_us));
  }
  return WriteOutput("", text);
}

Status AddToken(const UserArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto accounts, Open(arguments, StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(const Account account, FindAccount(*accounts, arguments));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string secret, MakeSecret());
  Credential token;
  VICTORIOUS_RETURN_IF_ERROR(accounts->ChangeAndLog([&]() -> Expected<AuditRecord> {
    VICTORIOUS_ASSIGN_OR_RETURN(token, accounts->AddCredential({.account = account.id,
                                                                .kind = CredentialKind::kToken,
                                                                .digest = DigestSecret(secret),
                                                                .label = arguments.label,
                                                                .now_us = NowUtcMicroseconds(),
                                                                .lifetime_us = kDay * arguments.days}));
    return EntryOf(arguments, "add_token", {{"token", token.id}, {"label", arguments.label}});
  }));
  if (!arguments.json) return WriteOutput("", secret + "\n");
  return WriteOutput("", DumpJson(Json({{"id", token.id},
                                        {"label", token.label},
                                        {"expires", FormatUtc(token.expires_utc_us)},
                                        {"token", secret}})) +
                             "\n");
}

Status Revoke(const UserArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto accounts, Open(arguments, StoreMode::kCreate));
  VICTORIOUS_ASSIGN_OR_RETURN(const Account account, FindAccount(*accounts, arguments));
  const Status revoked = accounts->ChangeAndLog([&]() -> Expected<AuditRecord> {
    VICTORIOUS_RETURN_IF_ERROR(accounts->RemoveCredential(account.id, arguments.token));
    return EntryOf(arguments, "revoke_token", {{"token", arguments.token}});
  });
  return PrintChanged(revoked, arguments, *accounts);
}

Status PrintLog(const UserArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto accounts, Open(arguments, StoreMode::kRead));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<AuditRecord> log, accounts->Audit(arguments.limit, std::nullopt));
  std::string text;
  for (const AuditRecord& one : log) {
    const std::string time = FormatUtc(one.time_utc_us);
    text += arguments.json ? DumpJson(Json({{"id", one.id},
                                            {"time", time},
                                            {"actor", one.actor},
                                            {"action", one.action},
                                            {"subject", one.subject},
                                            {"detail", one.detail}}))
                           : fmt::format("{} {:<16} {:<14} {} {}", time, one.actor.empty() ? "-" : OneLine(one.actor),
                                         one.action, OneLine(one.subject), OneLine(one.detail));
    text += "\n";
  }
  return WriteOutput("", text);
}

Argument AddRole(ArgumentParser& parser, std::string& role, const std::string& description) {
  return parser.Add("--role", role, description).TypeName("ROLE").OneOf({"viewer", "analyst", "admin"});
}

}  // namespace

Action SetUpUser(ArgumentParser& parser) {
  parser.RequireCommand();
  const auto arguments = std::make_shared<UserArguments>();
  std::vector<std::pair<ArgumentParser, Status (*)(const UserArguments&)>> parts;
  const auto add = [&](const char* name, const char* summary, Status (*run)(const UserArguments&),
                       const char* json) -> ArgumentParser {
    ArgumentParser part = parser.AddCommand(name, summary);
    AddDb(part, arguments->db, "The index that `victorious serve` shows");
    part.AddFlag("--json", arguments->json, json);
    parts.emplace_back(part, run);
    return part;
  };
  const auto add_named = [&](const char* name, const char* summary, Status (*run)(const UserArguments&),
                             const char* json =
                                 "Print one JSON object: the account as `user list` does") -> ArgumentParser {
    ArgumentParser part = add(name, summary, run, json);
    part.Add("NAME", arguments->name, "Of the account").Required();
    return part;
  };
  ArgumentParser added =
      add_named("add", "Add an account; its password is asked for, or read from standard input", &Add);
  AddRole(added, arguments->role, "viewer looks, analyst also reviews and adds videos, admin also reads the log")
      .Required();
  ArgumentParser changed = add_named("change", "Give an account another role or password", &Change);
  AddRole(changed, arguments->role, "The new role");
  changed.AddFlag("--password", arguments->has_new_password,
                  "Ask for a new password, or read it from standard input; ends sessions and tokens");
  add_named("remove", "Remove an account; what it reviewed stays", &Remove, "Print one JSON object: what is removed");
  add("list", "List the accounts and their tokens", &List, "Print JSON Lines");
  ArgumentParser token = add_named("token", "Print a new token, with which a script may do what the account may",
                                   &AddToken, "Print one JSON object: the token, its number, label and end");
  token.Add("--label", arguments->label, "What it is for").Required().TypeName("TEXT");
  token.Add("--days", arguments->days, "For how long it is valid").ShowDefault().Range(1, 3650).TypeName("N");
  add_named("revoke", "End a token", &Revoke)
      .Add("--token", arguments->token, "Its number in `victorious user list`")
      .Required()
      .TypeName("N");
  ArgumentParser log = add("log", "Print who did what, the latest first", &PrintLog, "Print JSON Lines");
  log.Add("--limit", arguments->limit, "At most so many entries").ShowDefault().Range(1, 1'000'000).TypeName("N");
  return [=]() -> Status {
    for (const auto& [part, run] : parts) {
      if (part.IsGiven()) return run(*arguments);
    }
    return {};  // not reached: one of them is required
  };
}

}  // namespace victorious::cli
