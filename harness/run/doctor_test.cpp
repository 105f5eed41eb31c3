#include "harness/run/doctor.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>

namespace raystudy {
namespace {

namespace fs = std::filesystem;

Machine quiet_machine() {
  Machine m;
  m.cpu = "A processor";
  m.microcode = "0x7";
  m.cores = 8;
  m.kernel = "6.1.0";
  m.governor = "performance";
  m.turbo = "off";
  m.smt = "off";
  m.virtual_machine = "no";
  m.huge_pages = "madvise";
  m.clock = "tsc";
  m.memory = 64.0 * (1 << 30);
  m.available_memory = 60.0 * (1 << 30);
  return m;
}

const Finding& about(const std::vector<Finding>& all, const std::string& subject) {
  for (const Finding& f : all) {
    if (f.subject == subject) return f;
  }
  throw std::logic_error("nothing about " + subject);
}

TEST(Doctor, FindsNothingWrongWithAQuietMachine) {
  for (const Finding& f : examine(quiet_machine(), {})) {
    EXPECT_EQ(f.health, Health::ok) << f.subject;
    EXPECT_EQ(f.advice, "") << f.subject;
  }
}

TEST(Doctor, WarnsOfAllThatDisturbsATiming) {
  Machine m = quiet_machine();
  m.governor = "powersave";
  m.turbo = "on";
  m.smt = "on";
  m.virtual_machine = "yes";
  m.huge_pages = "always";
  m.clock = "hpet";
  m.load = 3.456;
  m.available_memory = 1 << 30;
  m.swap_used = 1 << 20;
  const std::vector<Finding> all = examine(m, {{42, "backup", 0.87}});
  EXPECT_EQ(about(all, "governor").advice, "cpupower frequency-set --governor performance");
  for (const char* subject : {"governor", "turbo", "hyper-threading", "virtual machine", "huge pages", "clock", "load",
                              "busy process", "memory", "swap in use"}) {
    EXPECT_EQ(about(all, subject).health, Health::warn) << subject;
    EXPECT_NE(about(all, subject).advice, "") << subject;
  }
  EXPECT_EQ(about(all, "busy process").found, "backup (42): 87 % of a processor");
  EXPECT_EQ(about(all, "load").found, "3.46");
  EXPECT_EQ(about(all, "memory").found, "1 GiB free of 64 GiB");
}

TEST(Doctor, SaysWhatTheSystemDoesNotTell) {
  Machine m = quiet_machine();
  m.governor.clear();
  const Finding governor = about(examine(m, {}), "governor");
  EXPECT_EQ(governor.health, Health::warn);
  EXPECT_EQ(governor.found, "not told by the system");
}

TEST(Doctor, LooksForToolsOnThePath) {
  const fs::path folder = fs::path(testing::TempDir()) / fmt::format("tools-{}", getpid());
  fs::create_directories(folder);
  std::ofstream(folder / "node") << "#!/bin/sh\n";
  fs::permissions(folder / "node", fs::perms::owner_all);
  std::ofstream(folder / "npm") << "not to be executed";
  const std::vector<Finding> all = examine_tools("/nowhere:" + folder.string());
  EXPECT_EQ(about(all, "node").health, Health::ok);
  EXPECT_EQ(about(all, "npm").health, Health::missing);
  EXPECT_EQ(about(all, "rsvg-convert").advice, "apt-get install librsvg2-bin");
  fs::remove_all(folder);
}

TEST(Doctor, SaysWhichDevicesWillDo) {
  const std::vector<Finding> none = examine_devices({});
  ASSERT_EQ(none.size(), 1U);
  EXPECT_EQ(none.front().health, Health::missing);
  EXPECT_NE(none.front().advice.find("mesa-vulkan-drivers"), std::string::npos);
  vulkan::DeviceInfo good{.name = "card", .driver = "driver 1", .type = "discrete", .memory = 1U << 30U};
  vulkan::DeviceInfo bad = good;
  bad.unfit = "bufferDeviceAddress";
  const std::vector<Finding> all = examine_devices({good, bad});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].health, Health::ok);
  EXPECT_EQ(all[0].found, "discrete, driver 1, 1 GiB of memory");
  EXPECT_EQ(all[1].health, Health::missing);
  EXPECT_EQ(all[1].advice, "it lacks bufferDeviceAddress");
}

TEST(Doctor, ReadsAMachineFromProcAndSys) {
  const fs::path root = fs::path(testing::TempDir()) / fmt::format("machine-{}", getpid());
  const auto file = [&root](const std::string& path, const std::string& text) {
    fs::create_directories((root / path).parent_path());
    std::ofstream(root / path) << text;
  };
  file("proc/cpuinfo", "processor\t: 0\nmodel name\t: A \"fast\" one\nmicrocode\t: 0x2b\nflags\t\t: fpu hypervisor sse\n");
  file("proc/meminfo", "MemTotal:  1024 kB\nMemAvailable:  512 kB\nSwapTotal:  64 kB\nSwapFree:  60 kB\n");
  file("proc/sys/kernel/osrelease", "6.1.0-test\n");
  file("proc/loadavg", "1.25 0.64 0.30 1/101 28518\n");
  file("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n");
  file("sys/devices/system/cpu/intel_pstate/no_turbo", "0\n");
  file("sys/devices/system/cpu/smt/active", "1\n");
  file("sys/kernel/mm/transparent_hugepage/enabled", "always [madvise] never\n");
  file("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
  const Machine m = read_machine(root.string());
  EXPECT_EQ(m.cpu, "A \"fast\" one");
  EXPECT_EQ(m.microcode, "0x2b");
  EXPECT_EQ(m.kernel, "6.1.0-test");
  EXPECT_EQ(m.governor, "powersave");
  EXPECT_EQ(m.turbo, "on");
  EXPECT_EQ(m.smt, "on");
  EXPECT_EQ(m.virtual_machine, "yes");
  EXPECT_EQ(m.huge_pages, "madvise");
  EXPECT_EQ(m.clock, "tsc");
  EXPECT_EQ(m.memory, 1 << 20);
  EXPECT_EQ(m.available_memory, 1 << 19);
  EXPECT_EQ(m.swap_used, 4096);
  EXPECT_EQ(m.load, 1.25);
  fs::remove_all(root);
  EXPECT_EQ(read_machine(root.string()).governor, "") << "what is not there is empty";
}

TEST(Doctor, SeesABusyProcess) {
  const pid_t child = fork();
  if (child == 0) {
    for (std::atomic<unsigned> i = 0;;) ++i;
  }
  bool seen = false;
  // On a loaded machine it may get little time at first.
  for (int i = 0; i < 20 && !seen; ++i) {
    for (const BusyProcess& p : busy_processes(0.2)) seen = seen || p.pid == child;
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(seen);
}

TEST(Doctor, WritesLinesForPeopleAndJsonForPrograms) {
  const std::vector<Finding> all{{"machine", Health::ok, "load", "0.01", ""},
                                 {"tools", Health::missing, "node", "draws figures", "apt-get install nodejs"}};
  EXPECT_EQ(findings_text(all),
            "machine\n"
            "  ok       load  0.01\n"
            "\n"
            "tools\n"
            "  missing  node  draws figures\n"
            "                 → apt-get install nodejs\n");
  EXPECT_THAT(findings_json(all), testing::HasSubstr("\"advice\": \"apt-get install nodejs\""));
}

}  // namespace
}  // namespace raystudy
