!> A block on a compliant base: one history, and the contact by itself.
module api_soft_base
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: rows, history, contact, held

contains

   !> Rows of a history
   subroutine rows(count)
      use rocking_soft_base_response, only : soft_base_rows
      integer(c_int), intent(out) :: count
      count = int(soft_base_rows, c_int)
   end subroutine rows

   !> A block under one motion
   subroutine history(np, parameters, motions, motion, options, start, nt, time, nrows, room, &
                      counts, measures, state, event_kind, event, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take, motion_signal
      use common_signal, only : signal
      use common_status, only : status_ok, status_invalid_argument
      use rocking_modes, only : mode_history
      use rocking_soft_base, only : soft_base, soft_base_new
      use rocking_soft_base_response, only : soft_base_rock, soft_base_rows, soft_base_state
      integer(c_int), intent(in) :: np
      real(c_double), intent(in) :: parameters(np)          !! see rocking_soft_base
      integer(c_int64_t), intent(in) :: motions
      integer(c_int), intent(in) :: motion                  !! 1-based
      real(c_double), intent(in) :: options(3)              !! scale of the motion, end time [s], tolerance
      real(c_double), intent(in) :: start(4)                !! rotation [rad], sinking [m] and their rates
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: time(nt)                !! output times [s]
      integer(c_int), intent(in) :: nrows                   !! see rows
      integer(c_int), intent(in) :: room                    !! for events
      !> outcome, landings of the left and of the right edge, steps, half cycles, output times reached, events (may
      !> exceed room)
      integer(c_int), intent(out) :: counts(7)
      !> peaks of both coordinates, stop time [s], then the state at the end
      real(c_double), intent(out) :: measures(9)
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
         type(soft_base) :: body
         type(mode_history) :: record
         real(c_double) :: reached(soft_base_state)

         counts = 0
         measures = 0.0_c_double
         states = 0.0_c_double
         kinds = 0
         happened = 0.0_c_double
         status = status_invalid_argument
         if (nrows /= soft_base_rows) return
         call soft_base_new(parameters, body, status)
         if (status /= status_ok) return
         call motion_set_take(motions, .false., set, status)
         if (status /= status_ok) return
         call motion_signal(set, motion, options(1), ground, status)
         if (status == status_ok) then
            record%time => times
            record%state => states
            record%event_kind => kinds
            record%event => happened
            reached = 0.0_c_double
            reached(1:4) = start
            call soft_base_rock(body, ground, reached, options(2), options(3), record, status)
            counts = [record%outcome, record%impacts, record%steps, record%half_cycles, int(record%points, c_int), &
               int(record%events, c_int)]
            measures = [record%peak(), record%stop_time, reached]
         end if
         call handle_leave(motions)
      end subroutine with_targets

   end subroutine history

   !> What the base does to the block in a state
   subroutine contact(np, parameters, state, values, status)
      use common_status, only : status_ok
      use rocking_soft_base, only : base_contact, contact_of, take_signs, soft_base, soft_base_new
      integer(c_int), intent(in) :: np
      real(c_double), intent(in) :: parameters(np)
      real(c_double), intent(in) :: state(4)     !! rotation [rad], sinking [m] and their rates
      !> force up [N], its moment about the foot over the cosine [N m], energy stored [J], power taken up [W], range
      !> that presses [m], greatest pressure per length [N/m] or force of an edge [N]
      real(c_double), intent(out) :: values(7)
      integer(c_int), intent(out) :: status
      type(soft_base) :: body
      type(base_contact) :: found
      !f2py threadsafe
      values = 0.0_c_double
      call soft_base_new(parameters, body, status)
      if (status /= status_ok) return
      call take_signs(body, state)
      found = contact_of(body, state)
      values = [found%force, found%moment, found%stored, found%spent, found%range, found%most]
   end subroutine contact

   !> The block held at rotations and free to sink under its weight
   subroutine held(np, parameters, n, rotation, values, status)
      use common_status, only : status_ok
      use rocking_soft_base, only : find_restoring, soft_base, soft_base_new
      integer(c_int), intent(in) :: np
      real(c_double), intent(in) :: parameters(np)
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: rotation(n)   !! [rad]
      !> how far it sinks [m], energy of weight and springs [J], moment that turns it back [N m]
      real(c_double), intent(out) :: values(3, n)
      integer(c_int), intent(out) :: status
      type(soft_base) :: body
      integer :: k
      !f2py threadsafe
      values = 0.0_c_double
      call soft_base_new(parameters, body, status)
      if (status /= status_ok) return
      do k = 1, n
         call find_restoring(body, rotation(k), values(1, k), values(2, k), values(3, k))
      end do
   end subroutine held

end module api_soft_base
