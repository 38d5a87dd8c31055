!> Threads of a parallel loop: how many the system has room for, and how many of them a loop gains from.
module common_threads
   use common_kinds, only : wp
   use, intrinsic :: iso_c_binding, only : c_int
   use, intrinsic :: iso_fortran_env, only : int64
   use common_c_bindings, only : extrados_threads
   implicit none
   private
   public :: threads_available, thread_pace, choose_threads, learn_pace

   !> The number of threads, one or all, that takes steps faster: measured, as other processes on the machine change it.
   !> Both are tried in turn; the faster one then takes the steps for `rest` times as long as the trial took.
   type :: thread_pace
      real(wp) :: seconds(2) = 0.0_wp        !! of a step at the last trial, by one thread and by all
      real(wp) :: left = 0.0_wp              !! until the next trial [s]
      real(wp) :: spent = 0.0_wp             !! by this trial so far [s]
      integer :: steps = 0                   !! of the trial with this number of threads
      integer :: tried = 1                   !! 1: one thread, 2: all, 3: the trial is over
      integer :: faster = 1                  !! 1: one thread, 2: all
      integer(int64) :: begun = 0            !! clock at the last choice
   end type thread_pace

   integer, parameter :: least_steps = 8              !! of a trial
   real(wp), parameter :: trial = 0.01_wp, rest = 20.0_wp  !! [s], and times the time of a trial

contains

   !> As many of the wanted threads as can be started now, at least 1; what is computed does not depend on it
   function threads_available(wanted) result(count)
      integer(c_int), intent(in) :: wanted
      integer(c_int) :: count
      count = extrados_threads(wanted)
   end function threads_available

   !> Threads for the next steps, and how many steps they take before the next choice
   subroutine choose_threads(pace, most, count, threads, share)
      type(thread_pace), intent(inout) :: pace
      integer, intent(in) :: most            !! threads
      integer, intent(in) :: count           !! steps to take
      integer, intent(out) :: threads
      integer, intent(out) :: share          !! of the steps, at least 1
      threads = 1
      share = count
      if (most < 2) return
      call system_clock(pace%begun)
      if (pace%tried > 2) then
         if (pace%faster == 2) threads = most
         if (pace%seconds(pace%faster) * count > pace%left) share = 1 + int(pace%left / pace%seconds(pace%faster))
      else
         if (pace%tried == 2) threads = most
         share = least_steps
      end if
      share = min(share, count)
   end subroutine choose_threads

   !> What the steps after choose_threads have shown
   subroutine learn_pace(pace, most, steps)
      type(thread_pace), intent(inout) :: pace
      integer, intent(in) :: most            !! threads
      integer, intent(in) :: steps           !! taken since
      integer(int64) :: now, rate
      real(wp) :: elapsed
      if (most < 2) return
      call system_clock(now, rate)
      elapsed = max(real(now - pace%begun, wp) / rate, tiny(1.0_wp))
      if (pace%tried > 2) then
         pace%left = pace%left - elapsed
         if (pace%left <= 0.0_wp) pace%tried = 1
         return
      end if
      if (pace%steps == 0) pace%seconds(pace%tried) = 0.0_wp
      pace%seconds(pace%tried) = pace%seconds(pace%tried) + elapsed
      pace%steps = pace%steps + steps
      if (pace%steps < least_steps .or. pace%seconds(pace%tried) < trial) return
      pace%spent = pace%spent + pace%seconds(pace%tried)
      pace%seconds(pace%tried) = pace%seconds(pace%tried) / pace%steps
      pace%steps = 0
      pace%tried = pace%tried + 1
      if (pace%tried > 2) then
         pace%faster = merge(2, 1, pace%seconds(2) < pace%seconds(1))
         pace%left = rest * pace%spent
         pace%spent = 0.0_wp
      end if
   end subroutine learn_pace

end module common_threads
