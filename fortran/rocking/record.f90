!> What is recorded of a response besides its outcome: states at output times, events, work and loss.
module rocking_record
   use common_dense_step, only : dense_step
   use common_kinds, only : wp, gravity
   use rocking_equation, only : equation_of_motion
   use rocking_restraint, only : restraint_state
   use rocking_rocker, only : side_index
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: response_history, energy_of, cannot_reach

   !> Gauss points of a step
   real(wp), parameter :: node(3) = [0.1127016653792583_wp, 0.5_wp, 0.8872983346207417_wp]
   real(wp), parameter :: weight(3) = [5.0_wp, 8.0_wp, 5.0_wp] / 18.0_wp

   !> In the caller's arrays
   type :: response_history
      integer :: points = 0                        !! output times filled so far
      real(wp), pointer, contiguous :: time(:) => null()      !! requested, ascending [s]
      !> (8 or more, points): rotation, rate, acceleration, ground horizontal and vertical,
      !> kinetic and potential energy, energy put in minus energy lost at impacts and in restraints; then the energy
      !> stored in restraints and the force of each, where the array has rows for them
      real(wp), pointer, contiguous :: state(:, :) => null()
      integer :: events = 0                        !! found, also past the room for them
      integer(c_int), pointer, contiguous :: event_kind(:) => null()
      !> (2, room): time [s]; rotation at a peak or collapse [rad], rate before an impact [rad/s],
      !> both positive to +x; side at an uplift
      real(wp), pointer, contiguous :: event(:, :) => null()
      real(wp) :: work = 0.0_wp                    !! energy put in by the ground [J]
      real(wp) :: loss = 0.0_wp                    !! energy lost at impacts [J]
      type(restraint_state), allocatable :: memory(:)  !! of the restraints, in the end
      real(wp) :: spent = 0.0_wp                   !! energy taken up by dampers and yielding [J]
   contains
      procedure :: note_event
      procedure :: book_loss
      procedure :: cover_step
      procedure :: fill_rest
   end type response_history

contains

   !> An event; past the room it is only counted
   subroutine note_event(history, kind, when, value)
      class(response_history), intent(inout) :: history
      integer(c_int), intent(in) :: kind
      real(wp), intent(in) :: when   !! [s]
      real(wp), intent(in) :: value  !! see event
      history%events = history%events + 1
      if (history%events > size(history%event_kind)) return
      history%event_kind(history%events) = kind
      history%event(:, history%events) = [when, value]
   end subroutine note_event

   !> Book kinetic energy at rest as lost, or as gained back
   subroutine book_loss(history, problem, rate, sign)
      class(response_history), intent(inout) :: history
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: rate  !! [rad/s]
      real(wp), intent(in) :: sign  !! +1 lost, -1 gained
      history%loss = history%loss + sign * energy_of(problem, 0.0_wp, rate)
   end subroutine book_loss

   !> Fill the output times that the first part of a step covers, and book the work done over it
   subroutine cover_step(history, problem, step, covered)
      class(response_history), intent(inout) :: history
      type(equation_of_motion), intent(in) :: problem
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: covered  !! fraction of the step
      real(wp) :: x, end_time, rotation, rate, horizontal, vertical, energy, potential, sigma

      sigma = real(problem%side, wp)
      end_time = step%t + covered * step%h
      do while (history%points < size(history%time))
         if (history%time(history%points + 1) > end_time) exit
         history%points = history%points + 1
         x = max(0.0_wp, (history%time(history%points) - step%t) / step%h)
         rotation = max(step%coordinate(x), 0.0_wp)
         rate = step%rate(x)
         call problem%ground%value_at(problem%segment, history%time(history%points), horizontal, vertical)
         energy = energy_of(problem, rotation, rate)
         potential = problem%body%potential(problem%side, rotation)
         history%state(:8, history%points) = [sigma * rotation, sigma * rate, &
            sigma * problem%acceleration(history%time(history%points), rotation, rate), horizontal, vertical, &
            energy - potential, potential, history%work + work_of(problem, step, x) - history%loss - history%spent]
         if (allocated(problem%memory)) then
            history%state(8, history%points) = history%state(8, history%points) - spent_in(problem, step, x)
            call restraint_rows(history, problem, rotation, rate)
         end if
      end do
      history%work = history%work + work_of(problem, step, covered)
      if (allocated(problem%memory)) history%spent = history%spent + spent_in(problem, step, covered)
   end subroutine cover_step

   !> Fill the output times of a rest
   subroutine fill_rest(history, problem, until)
      class(response_history), intent(inout) :: history
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: until  !! [s]
      real(wp) :: horizontal, vertical
      do while (history%points < size(history%time))
         if (history%time(history%points + 1) > until) exit
         history%points = history%points + 1
         call problem%ground%value_at(problem%segment, history%time(history%points), horizontal, vertical)
         history%state(:, history%points) = 0.0_wp
         history%state(4:5, history%points) = [horizontal, vertical]
         history%state(8, history%points) = history%work - history%loss - history%spent
         if (allocated(problem%memory)) call restraint_rows(history, problem, 0.0_wp, 0.0_wp)
      end do
   end subroutine fill_rest

   !> What restraints store, and their forces, in the rows for them
   subroutine restraint_rows(history, problem, rotation, rate)
      class(response_history), intent(inout) :: history
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: rotation  !! [rad]
      real(wp), intent(in) :: rate      !! [rad/s]
      integer :: i
      if (size(history%state, 1) < 9 + problem%body%held%count) return
      i = side_index(problem%side)
      history%state(9, history%points) = problem%body%held%energy(i, rotation, problem%memory)
      call problem%body%held%find_forces(i, rotation, rate, problem%memory, &
         history%state(10:9 + problem%body%held%count, history%points))
   end subroutine restraint_rows

   !> Kinetic plus potential energy [J]
   pure function energy_of(problem, rotation, rate) result(energy)
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: rotation  !! [rad]
      real(wp), intent(in) :: rate      !! [rad/s]
      real(wp) :: energy
      real(wp) :: m, half_dm, dv, dh
      logical :: closed
      call problem%body%coefficients(problem%side, rotation, m, half_dm, dv, dh, closed)
      energy = 0.5_wp * m * rate**2 + problem%body%potential(problem%side, rotation)
   end function energy_of

   !> Too little energy is left to reach a share of the critical rotation of any side, over the restraints as they are
   pure function cannot_reach(problem, rotation, rate, share) result(answer)
      type(equation_of_motion), intent(in) :: problem
      real(wp), intent(in) :: rotation  !! below the critical one [rad]
      real(wp), intent(in) :: rate      !! [rad/s]
      real(wp), intent(in) :: share     !! at most 1
      logical :: answer
      real(wp) :: energy, barrier, there
      integer :: i
      energy = energy_of(problem, rotation, rate)
      answer = .true.
      do i = 1, 2
         if (.not. problem%body%free(i)) cycle
         there = share * problem%body%critical(i)
         barrier = problem%body%potential(3 - 2 * i, there)
         if (allocated(problem%memory)) barrier = barrier &
            + problem%body%held%work_to(side_index(problem%side), rotation, i, there, problem%memory)
         answer = answer .and. energy < barrier
      end do
   end function cannot_reach

   !> Work of the ground over the first part of a step, by three Gauss points on the dense output
   !> (thesis Eq. 6.4)
   function work_of(problem, step, fraction) result(work)
      type(equation_of_motion), intent(in) :: problem
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: fraction
      real(wp) :: work
      real(wp) :: m, half_dm, dv, dh, horizontal, vertical, x
      logical :: closed
      integer :: j

      work = 0.0_wp
      do j = 1, 3
         x = fraction * node(j)
         call problem%body%coefficients(problem%side, step%coordinate(x), m, half_dm, dv, dh, closed)
         call problem%ground%value_at(problem%segment, step%t + x * step%h, horizontal, vertical)
         work = work - weight(j) * fraction * step%h * step%rate(x) &
            * (real(problem%side, wp) * horizontal * dh + dv * vertical / gravity)
      end do
   end function work_of

   !> Energy that dampers and yielding take up over the first part of a step, by the same points
   function spent_in(problem, step, fraction) result(energy)
      type(equation_of_motion), intent(in) :: problem
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: fraction
      real(wp) :: energy
      real(wp) :: x
      integer :: j
      energy = 0.0_wp
      do j = 1, 3
         x = fraction * node(j)
         energy = energy + weight(j) * fraction * step%h * problem%body%held%dissipation(side_index(problem%side), &
            step%coordinate(x), step%rate(x), problem%memory)
      end do
   end function spent_in

end module rocking_record
