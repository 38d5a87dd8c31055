!> Two stacked blocks that rock: one history, and the impact by itself.
module api_stack
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: rows, history, impact

contains

   !> Rows of a history
   subroutine rows(count)
      use rocking_stack_response, only : stack_rows
      integer(c_int), intent(out) :: count
      count = int(stack_rows, c_int)
   end subroutine rows

   !> Two blocks under one motion
   subroutine history(np, parameters, motions, motion, options, start, nt, time, nrows, room, &
                      counts, measures, state, event_kind, event, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take, motion_signal
      use common_signal, only : signal
      use common_status, only : status_ok, status_invalid_argument
      use rocking_modes, only : mode_history
      use rocking_stack, only : stack, stack_new
      use rocking_stack_response, only : stack_rock, stack_rows
      integer(c_int), intent(in) :: np
      real(c_double), intent(in) :: parameters(np)          !! see rocking_stack
      integer(c_int64_t), intent(in) :: motions
      integer(c_int), intent(in) :: motion                  !! 1-based
      real(c_double), intent(in) :: options(3)              !! scale of the motion, end time [s], tolerance
      real(c_double), intent(in) :: start(4)                !! rotations [rad] and rates [rad/s], lower and upper
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: time(nt)                !! output times [s]
      integer(c_int), intent(in) :: nrows                   !! see rows
      integer(c_int), intent(in) :: room                    !! for events
      !> outcome, impacts at the ground and between, steps, settled, output times reached, events (may exceed room),
      !> half cycles
      integer(c_int), intent(out) :: counts(8)
      real(c_double), intent(out) :: measures(5)            !! peaks [rad], stop time [s], work, loss [J]
      real(c_double), intent(out) :: state(nrows, nt)
      integer(c_int), intent(out) :: event_kind(room)
      real(c_double), intent(out) :: event(2, room)
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call with_targets(time, state, event_kind, event)

   contains

      !> The arrays as pointer targets for the length of the call
      subroutine with_targets(times, states, kinds, happened)
         real(c_double), intent(in), target, contiguous :: times(:)
         real(c_double), intent(out), target, contiguous :: states(:, :), happened(:, :)
         integer(c_int), intent(out), target, contiguous :: kinds(:)
         type(motion_set), pointer :: set
         type(signal) :: ground
         type(stack) :: body
         type(mode_history) :: record
         real(c_double) :: work

         counts = 0
         measures = 0.0_c_double
         states = 0.0_c_double
         kinds = 0
         happened = 0.0_c_double
         status = status_invalid_argument
         if (nrows /= stack_rows) return
         call stack_new(parameters, body, status)
         if (status /= status_ok) return
         call motion_set_take(motions, .false., set, status)
         if (status /= status_ok) return
         call motion_signal(set, motion, options(1), ground, status)
         if (status == status_ok) then
            record%time => times
            record%state => states
            record%event_kind => kinds
            record%event => happened
            call stack_rock(body, ground, start, options(2), options(3), record, work, status)
            counts = [record%outcome, record%impacts, record%steps, merge(1_c_int, 0_c_int, record%settled), &
               int(record%points, c_int), int(record%events, c_int), record%half_cycles]
            measures = [record%peak(), record%stop_time, work, record%loss]
         end if
         call handle_leave(motions)
      end subroutine with_targets

   end subroutine history

   !> Rates after contacts close
   subroutine impact(np, parameters, pivots, rotation, rate, closing, pivots_after, rate_after, status)
      use common_status, only : status_ok
      use rocking_stack, only : stack, stack_impact, stack_new
      integer(c_int), intent(in) :: np
      real(c_double), intent(in) :: parameters(np)
      integer(c_int), intent(in) :: pivots(2)          !! of the ground and between: +1, -1, 0 shut
      real(c_double), intent(in) :: rotation(2)        !! [rad]
      real(c_double), intent(in) :: rate(2)            !! before [rad/s]
      integer(c_int), intent(in) :: closing(2)         !! 1 where a contact closes
      integer(c_int), intent(out) :: pivots_after(2)
      real(c_double), intent(out) :: rate_after(2)
      integer(c_int), intent(out) :: status
      type(stack) :: body
      integer :: found(2)
      !f2py threadsafe
      pivots_after = 0
      rate_after = 0.0_c_double
      call stack_new(parameters, body, status)
      if (status /= status_ok) return
      call stack_impact(body, int(pivots), rotation, rate, closing == 1, found, rate_after)
      pivots_after = int(found, c_int)
   end subroutine impact

end module api_stack
