!> Rocking responses: one with its history, or many.
!>
!> Motions come as one set of flat arrays, see rocking_ensemble's motion_set.
module api_rocking
   use, intrinsic :: iso_c_binding, only : c_double, c_int
   implicit none
   private
   public :: history, ensemble

contains

   !> One run with its history and events
   subroutine history(kind, np, body, sampled, channels, npoint, start, step, samples, &
                      nbreak, terms, breaks, linear, harmonic, scale, &
                      end_time, tolerance, start_side, start_q, start_v, nt, time, room, &
                      outcome, state, points, event_kind, event, events, summary, work, loss, status)
      use common_signal, only : signal, signal_sampled, signal_piecewise
      use common_status, only : status_ok
      use rocking_ensemble, only : make_body
      use rocking_response, only : respond, response, response_options, response_history
      use rocking_rocker, only : rocker
      integer(c_int), intent(in) :: kind                    !! of structure
      integer(c_int), intent(in) :: np                      !! length of its parameter list
      real(c_double), intent(in) :: body(np)
      integer(c_int), intent(in) :: sampled                 !! 1: samples, 0: pieces
      integer(c_int), intent(in) :: channels                !! 1 horizontal, 2 with vertical
      integer(c_int), intent(in) :: npoint
      real(c_double), intent(in) :: start                   !! [s]
      real(c_double), intent(in) :: step                    !! [s]
      real(c_double), intent(in) :: samples(channels, npoint)  !! [m/s^2]
      integer(c_int), intent(in) :: nbreak
      integer(c_int), intent(in) :: terms
      real(c_double), intent(in) :: breaks(nbreak)          !! [s]
      real(c_double), intent(in) :: linear(2, channels, nbreak)
      real(c_double), intent(in) :: harmonic(4, terms, channels, nbreak)
      real(c_double), intent(in) :: scale
      real(c_double), intent(in) :: end_time                !! [s]
      real(c_double), intent(in) :: tolerance
      integer(c_int), intent(in) :: start_side              !! +1 or -1
      real(c_double), intent(in) :: start_q                 !! [rad]
      real(c_double), intent(in) :: start_v                 !! [rad/s]
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: time(nt)                !! output times [s]
      integer(c_int), intent(in) :: room                    !! for events
      integer(c_int), intent(out) :: outcome(6)             !! outcome, half cycles, impacts, steps, rejected, settled
      real(c_double), intent(out) :: state(8, nt)           !! see response_history
      integer(c_int), intent(out) :: points                 !! output times reached
      integer(c_int), intent(out) :: event_kind(room)
      real(c_double), intent(out) :: event(2, room)
      integer(c_int), intent(out) :: events                 !! found, may exceed room
      real(c_double), intent(out) :: summary(3)             !! peak [rad], peak ratio, stop time [s]
      real(c_double), intent(out) :: work                   !! of the ground [J]
      real(c_double), intent(out) :: loss                   !! at impacts [J]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call with_targets(body, samples, breaks, linear, harmonic, time, state, event_kind, event)

   contains

      !> The arrays as pointer targets for the length of the call
      subroutine with_targets(parameters, values, edges, lines, sines, times, states, kinds, happened)
         real(c_double), intent(in) :: parameters(:)
         real(c_double), intent(in), target, contiguous :: values(:, :), edges(:), lines(:, :, :)
         real(c_double), intent(in), target, contiguous :: sines(:, :, :, :)
         real(c_double), intent(in), target, contiguous :: times(:)
         real(c_double), intent(out), target, contiguous :: states(:, :), happened(:, :)
         integer(c_int), intent(out), target, contiguous :: kinds(:)
         class(rocker), allocatable :: structure
         type(signal) :: ground
         type(response) :: answer
         type(response_history) :: record

         outcome = 0
         states = 0.0_c_double
         kinds = 0
         happened = 0.0_c_double
         points = 0
         events = 0
         summary = 0.0_c_double
         work = 0.0_c_double
         loss = 0.0_c_double
         call make_body(kind, parameters, structure, status)
         if (status /= status_ok) return
         if (sampled /= 0) then
            ground = signal_sampled(start, step, values, scale)
         else
            ground = signal_piecewise(edges, lines(:, :, 1:nbreak - 1), sines(:, :, :, 1:nbreak - 1), scale)
         end if
         record%time => times
         record%state => states
         record%event_kind => kinds
         record%event => happened
         call respond(structure, ground, response_options(end_time=end_time, tolerance=tolerance, &
            start_q=start_q, start_v=start_v, start_side=int(start_side)), answer, status, record)
         outcome = [answer%outcome, answer%half_cycles, answer%impacts, answer%steps, answer%rejected, &
            merge(1_c_int, 0_c_int, answer%settled)]
         summary = [answer%peak, answer%peak_ratio, answer%stop_time]
         points = int(record%points, c_int)
         events = int(record%events, c_int)
         work = record%work
         loss = record%loss
      end subroutine with_targets

   end subroutine history

   !> Many runs without histories; run_status tells each member's fate
   subroutine ensemble(nbody, np, kind, bodies, nmotion, channels, terms, npoint, nbreak, sampled, first, segments, &
                       start, step, samples, breaks, linear, harmonic, nrun, run_body, run_motion, run_scale, &
                       end_time, start_q, tolerance, stop_when_safe, threads, outcome, peak, stop_time, &
                       run_status, status)
      use rocking_ensemble, only : run_ensemble, motion_set
      use rocking_response, only : response, response_options
      use common_status, only : status_out_of_memory
      integer(c_int), intent(in) :: nbody
      integer(c_int), intent(in) :: np
      integer(c_int), intent(in) :: kind(nbody)
      real(c_double), intent(in) :: bodies(np, nbody)
      integer(c_int), intent(in) :: nmotion
      integer(c_int), intent(in) :: channels
      integer(c_int), intent(in) :: terms
      integer(c_int), intent(in) :: npoint
      integer(c_int), intent(in) :: nbreak
      integer(c_int), intent(in) :: sampled(nmotion)
      integer(c_int), intent(in) :: first(nmotion)          !! 1-based
      integer(c_int), intent(in) :: segments(nmotion)
      real(c_double), intent(in) :: start(nmotion)          !! [s]
      real(c_double), intent(in) :: step(nmotion)           !! [s]
      real(c_double), intent(in) :: samples(channels, npoint)  !! [m/s^2]
      real(c_double), intent(in) :: breaks(nbreak)          !! [s]
      real(c_double), intent(in) :: linear(2, channels, nbreak)
      real(c_double), intent(in) :: harmonic(4, terms, channels, nbreak)
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
      integer(c_int), intent(out) :: run_status(nrun)
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call with_targets(sampled, first, segments, start, step, samples, breaks, linear, harmonic)

   contains

      subroutine with_targets(forms, firsts, counts, starts, steps, values, edges, lines, sines)
         integer(c_int), intent(in), target, contiguous :: forms(:), firsts(:), counts(:)
         real(c_double), intent(in), target, contiguous :: starts(:), steps(:), values(:, :), edges(:)
         real(c_double), intent(in), target, contiguous :: lines(:, :, :), sines(:, :, :, :)
         type(motion_set) :: set
         type(response), allocatable :: answers(:)
         type(response_options), allocatable :: options(:)
         integer :: k, stat

         outcome = 0
         peak = 0.0_c_double
         stop_time = 0.0_c_double
         run_status = 0
         allocate (answers(nrun), options(nrun), stat=stat)
         if (stat /= 0) then
            status = status_out_of_memory
            return
         end if
         set = motion_set(forms, firsts, counts, starts, steps, values, edges, lines, sines)
         do k = 1, nrun
            options(k)%end_time = end_time(k)
            options(k)%start_q = abs(start_q(k))
            options(k)%start_side = merge(1, -1, start_q(k) >= 0.0_c_double)
            options(k)%tolerance = tolerance
            options(k)%stop_when_safe = stop_when_safe /= 0
         end do
         call run_ensemble(kind, bodies, set, run_body, run_motion, run_scale, options, threads, answers, &
            run_status, status)
         do k = 1, nrun
            outcome(:, k) = [answers(k)%outcome, answers(k)%half_cycles, answers(k)%impacts, answers(k)%steps, &
               merge(1_c_int, 0_c_int, answers(k)%settled)]
            peak(:, k) = [answers(k)%peak, answers(k)%peak_ratio]
            stop_time(k) = answers(k)%stop_time
         end do
      end subroutine with_targets

   end subroutine ensemble

end module api_rocking
