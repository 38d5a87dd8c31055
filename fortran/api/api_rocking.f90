!> Rocking responses: one with its history, or many. Structures and motions come as handles.
module api_rocking
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: create, body, limits, history, ensemble

contains

   !> A list with room for `count` structures
   subroutine create(count, handle, status)
      use rocking_handle, only : body_list_new
      integer(c_int), intent(in) :: count
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      call body_list_new(count, handle, status)
   end subroutine create

   !> One structure of a list
   subroutine body(handle, number, kind, np, parameters, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use rocking_ensemble, only : body_list
      use rocking_handle, only : body_list_take, set_body
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: number              !! 1-based
      integer(c_int), intent(in) :: kind                !! rocking_body of extrados_lists.h
      integer(c_int), intent(in) :: np
      real(c_double), intent(in) :: parameters(np)      !! see the kind's module
      integer(c_int), intent(out) :: status
      type(body_list), pointer :: list
      call body_list_take(handle, .true., list, status)
      if (status /= status_ok) return
      call set_body(list, number, kind, parameters, status)
      call handle_leave(handle)
   end subroutine body

   !> Rotations of unstable equilibrium and those taken as collapse, to +x and to -x [rad]
   subroutine limits(handle, number, critical, limit, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use rocking_ensemble, only : body_list, list_body
      use rocking_handle, only : body_list_take
      use rocking_rocker, only : rocker
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: number              !! 1-based
      real(c_double), intent(out) :: critical(2)
      real(c_double), intent(out) :: limit(2)
      integer(c_int), intent(out) :: status
      class(rocker), allocatable :: structure
      type(body_list), pointer :: list
      critical = 0.0_c_double
      limit = 0.0_c_double
      call body_list_take(handle, .false., list, status)
      if (status /= status_ok) return
      call list_body(list, number, structure, status)
      if (status == status_ok) then
         critical = structure%critical
         limit = structure%limit
      end if
      call handle_leave(handle)
   end subroutine limits

   !> One structure under one motion, with its history and events
   subroutine history(bodies, motions, member, options, start, nt, time, room, restraints, &
                      counts, measures, state, kept, event_kind, event, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take, motion_signal
      use common_signal, only : signal
      use common_status, only : status_ok
      use rocking_ensemble, only : body_list, list_body
      use rocking_handle, only : body_list_take
      use rocking_response, only : find_response, response, response_options, response_history
      use rocking_rocker, only : rocker
      integer(c_int64_t), intent(in) :: bodies
      integer(c_int64_t), intent(in) :: motions
      integer(c_int), intent(in) :: member(2)               !! structure and motion, 1-based
      real(c_double), intent(in) :: options(3)              !! scale of the motion, end time [s], tolerance
      real(c_double), intent(in) :: start(3)                !! side (+1 or -1), rotation [rad], rate [rad/s]
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: time(nt)                !! output times [s]
      integer(c_int), intent(in) :: room                    !! for events
      integer(c_int), intent(in) :: restraints              !! that the structure has
      !> outcome, half cycles, impacts, steps, rejected, settled, output times reached, events (may exceed room)
      integer(c_int), intent(out) :: counts(8)
      !> peak [rad], peak ratio, stop time [s], work, loss, spent in restraints [J], the demand on the joints
      !> (see joint_demand)
      real(c_double), intent(out) :: measures(12)
      real(c_double), intent(out) :: state(9 + restraints, nt)  !! see response_history
      real(c_double), intent(out) :: kept(3, restraints)    !! of each: least, greatest force, path that stays
      integer(c_int), intent(out) :: event_kind(room)
      real(c_double), intent(out) :: event(2, room)
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call with_targets(time, state, kept, event_kind, event)

   contains

      !> The arrays as pointer targets for the length of the call
      subroutine with_targets(times, states, held, kinds, happened)
         real(c_double), intent(in), target, contiguous :: times(:)
         real(c_double), intent(out), target, contiguous :: states(:, :), happened(:, :)
         real(c_double), intent(out) :: held(:, :)
         integer(c_int), intent(out), target, contiguous :: kinds(:)
         class(rocker), allocatable :: structure
         type(body_list), pointer :: list
         type(motion_set), pointer :: set
         type(signal) :: ground
         type(response) :: answer
         type(response_history) :: record

         counts = 0
         measures = 0.0_c_double
         states = 0.0_c_double
         held = 0.0_c_double
         kinds = 0
         happened = 0.0_c_double
         call body_list_take(bodies, .false., list, status)
         if (status /= status_ok) return
         call list_body(list, member(1), structure, status)
         call handle_leave(bodies)
         if (status /= status_ok) return
         call motion_set_take(motions, .false., set, status)
         if (status /= status_ok) return
         call motion_signal(set, member(2), options(1), ground, status)
         if (status == status_ok) then
            record%time => times
            record%state => states
            record%event_kind => kinds
            record%event => happened
            call find_response(structure, ground, response_options(end_time=options(2), tolerance=options(3), &
               start_q=start(2), start_v=start(3), start_side=merge(1, -1, start(1) > 0.0_c_double)), answer, status, &
               record)
            counts = [answer%outcome, answer%half_cycles, answer%impacts, answer%steps, answer%rejected, &
               merge(1_c_int, 0_c_int, answer%settled), int(record%points, c_int), int(record%events, c_int)]
            measures = [answer%peak, answer%peak_ratio, answer%stop_time, record%work, record%loss, record%spent, &
               answer%joints%flat()]
            if (allocated(record%memory)) then
               if (size(record%memory) == restraints) then
                  held(1, :) = record%memory%least
                  held(2, :) = record%memory%most
                  held(3, :) = record%memory%set
               end if
            end if
         end if
         call handle_leave(motions)
      end subroutine with_targets

   end subroutine history

   !> Many runs without histories; run_status has the outcome of each member
   subroutine ensemble(bodies, motions, nrun, run_body, run_motion, run_scale, end_time, start_q, &
                       tolerance, stop_when_safe, threads, outcome, peak, stop_time, demand, run_status, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take
      use common_status, only : status_ok, status_out_of_memory
      use common_threads, only : threads_available
      use rocking_ensemble, only : body_list, run_ensemble
      use rocking_handle, only : body_list_take
      use rocking_response, only : response, response_options
      integer(c_int64_t), intent(in) :: bodies
      integer(c_int64_t), intent(in) :: motions
      integer(c_int), intent(in) :: nrun
      integer(c_int), intent(in) :: run_body(nrun)          !! 1-based
      integer(c_int), intent(in) :: run_motion(nrun)        !! 1-based
      real(c_double), intent(in) :: run_scale(nrun)
      real(c_double), intent(in) :: end_time(nrun)          !! [s]
      real(c_double), intent(in) :: start_q(nrun)           !! initial rotation, > 0 to +x [rad]
      real(c_double), intent(in) :: tolerance
      integer(c_int), intent(in) :: stop_when_safe          !! 1: outcome and peak only
      integer(c_int), intent(in) :: threads
      integer(c_int), intent(out) :: outcome(5, nrun)       !! outcome, half cycles, impacts, steps, settled
      real(c_double), intent(out) :: peak(2, nrun)          !! rotation [rad], ratio to the critical
      real(c_double), intent(out) :: stop_time(nrun)        !! [s]
      real(c_double), intent(out) :: demand(6, nrun)        !! on the joints, see joint_demand
      integer(c_int), intent(out) :: run_status(nrun)
      integer(c_int), intent(out) :: status
      type(response), allocatable :: answers(:)
      type(response_options), allocatable :: options(:)
      type(body_list), pointer :: list
      type(motion_set), pointer :: set
      integer :: k, failed
      !f2py threadsafe
      outcome = 0
      peak = 0.0_c_double
      stop_time = 0.0_c_double
      demand = 0.0_c_double
      run_status = 0
      status = status_out_of_memory
      allocate (answers(nrun), options(nrun), stat=failed)
      if (failed /= 0) return
      call body_list_take(bodies, .false., list, status)
      if (status /= status_ok) return
      call motion_set_take(motions, .false., set, status)
      if (status == status_ok) then
         do k = 1, nrun
            options(k)%end_time = end_time(k)
            options(k)%start_q = abs(start_q(k))
            options(k)%start_side = merge(1, -1, start_q(k) >= 0.0_c_double)
            options(k)%tolerance = tolerance
            options(k)%stop_when_safe = stop_when_safe /= 0
         end do
         call run_ensemble(list, set, run_body, run_motion, run_scale, options, threads_available(threads), answers, &
            run_status, status)
         do k = 1, nrun
            outcome(:, k) = [answers(k)%outcome, answers(k)%half_cycles, answers(k)%impacts, answers(k)%steps, &
               merge(1_c_int, 0_c_int, answers(k)%settled)]
            peak(:, k) = [answers(k)%peak, answers(k)%peak_ratio]
            stop_time(k) = answers(k)%stop_time
            demand(:, k) = answers(k)%joints%flat()
         end do
         call handle_leave(motions)
      end if
      call handle_leave(bodies)
   end subroutine ensemble

end module api_rocking
