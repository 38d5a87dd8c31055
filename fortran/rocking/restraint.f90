!> Restraints of a rocking structure besides its weight: ties, springs, dampers, each on a path of one coordinate.
!>
!> Along its path u(q) a restraint pulls with the force f(u, u') against growing u, which enters the equation of motion
!> as the moment f du/dq. The force is that of a spring between bounds,
!>
!>    f = prestress + k (u - u_set)   while least <= f <= most,
!>
!> and c |u'|^n beside it. A bound is one of slackness, which leaves no trace, or one of yield or sliding, where u_set
!> follows. Within a step of the integrator every restraint stays in its mode, in which its force is smooth; the step
!> ends where the first one leaves its mode, so that the order of the method holds.
module rocking_restraint
   use common_dense_step, only : dense_step
   use common_kinds, only : wp
   use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
   use mechanism_path, only : path_numbers, path_table, path_unpack
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: restraint_set, restraint_state, restraint_set_new, law_numbers

   !> Numbers of a law: k [N/m], prestress [N], most, least [N], slack (1 below least, -1 above most, 0 yields at both
   !> bounds), c [N (s/m)^n], n; of a turn N m and rad
   integer, parameter :: law_numbers = 7
   integer, parameter :: elastic = 0, yields_up = 1, yields_down = 2, slack = 3
   !> Of the greatest path, force: what leaves a mode is more than rounding
   real(wp), parameter :: rounding = 1.0e-13_wp
   integer, parameter :: looks = 8  ! at a step, for what leaves its mode

   type :: restraint_law
      real(wp) :: stiffness = 0.0_wp, prestress = 0.0_wp
      real(wp) :: most = huge(1.0_wp), least = -huge(1.0_wp)
      integer :: slack = 0               !! +1: a tie, slack below least; -1: a strut, slack above most
      real(wp) :: viscous = 0.0_wp, power = 1.0_wp
      real(wp) :: slop = 0.0_wp          !! force that is rounding
   contains
      procedure :: trial
      procedure :: stored
      procedure :: resisted
   end type restraint_law

   !> What a restraint remembers
   type :: restraint_state
      integer :: mode = elastic
      real(wp) :: set = 0.0_wp    !! u that stays
      real(wp) :: least = 0.0_wp  !! least and greatest force so far
      real(wp) :: most = 0.0_wp
   end type restraint_state

   type :: restraint_set
      integer :: count = 0
      type(restraint_law), allocatable :: law(:)
      type(path_table) :: path(2)   !! rocking to +x and to -x
   contains
      procedure :: reset_states
      procedure :: find_forces
      procedure :: moment
      procedure :: energy
      procedure :: dissipation
      procedure :: find_leaving
      procedure :: change_mode
      procedure :: settle_springs
      procedure :: note_forces
      procedure :: work_to
      procedure :: first_moment
   end type restraint_set

contains

   !> Set up from the flat list: per restraint its law (law_numbers), then the paths to +x and to -x
   subroutine restraint_set_new(list, count, set, status)
      real(wp), intent(in) :: list(:)
      integer, intent(in) :: count                 !! restraints, at least one
      type(restraint_set), intent(out) :: set
      integer(c_int), intent(out) :: status
      real(wp) :: u, du, reach
      integer :: i, k, n, first, stat

      status = status_invalid_argument
      n = path_numbers(count)
      if (count < 1 .or. size(list) /= count * law_numbers + 2 * n) return
      set%count = count
      do i = 1, 2
         first = count * law_numbers + (i - 1) * n
         call path_unpack(list(first + 1:first + n), count, set%path(i), status)
         if (status /= status_ok) return
      end do
      allocate (set%law(count), stat=stat)
      status = status_out_of_memory
      if (stat /= 0) return
      status = status_invalid_argument
      do k = 1, count
         reach = 0.0_wp
         do i = 1, 2
            do n = 0, 16
               call set%path(i)%evaluate_path(k, 0.5_wp * set%path(i)%scale * real(n, wp) / 16.0_wp, u, du)
               reach = max(reach, abs(u))
            end do
         end do
         associate (row => list((k - 1) * law_numbers + 1:k * law_numbers), law => set%law(k))
            law%stiffness = row(1)
            law%prestress = row(2)
            law%most = row(3)
            law%least = row(4)
            law%slack = nint(row(5))
            law%viscous = row(6)
            law%power = row(7)
            if (row(1) < 0.0_wp .or. row(6) < 0.0_wp .or. .not. row(7) > 0.0_wp) return
            if (.not. (row(4) <= row(2) .and. row(2) <= row(3) .and. row(4) < row(3))) return
            ! bounds without a spring have no elongation at which they are left
            if (.not. row(1) > 0.0_wp .and. max(row(3), -row(4)) < huge(1.0_wp)) return
            law%slop = rounding * (law%stiffness * reach + abs(law%prestress))
            if (law%most < huge(1.0_wp)) law%slop = law%slop + rounding * abs(law%most)
            if (law%least > -huge(1.0_wp)) law%slop = law%slop + rounding * abs(law%least)
         end associate
      end do
      status = status_ok
   end subroutine restraint_set_new

   !> The states after the structure was brought from rest to q once
   pure subroutine reset_states(set, i, q, state)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i                           !! 1 to +x, 2 to -x
      real(wp), intent(in) :: q                          !! [rad]
      type(restraint_state), intent(out) :: state(:)
      real(wp) :: u, du
      integer :: k
      do k = 1, set%count
         call set%path(i)%evaluate_path(k, q, u, du)
         state(k)%least = set%law(k)%prestress
         state(k)%most = set%law(k)%prestress
         call carry_spring(set%law(k), state(k), 0.0_wp, u)
      end do
   end subroutine reset_states

   !> Force of the spring without its bounds
   pure function trial(law, state, u) result(f)
      class(restraint_law), intent(in) :: law
      type(restraint_state), intent(in) :: state
      real(wp), intent(in) :: u
      real(wp) :: f
      f = law%prestress + law%stiffness * (u - state%set)
   end function trial

   !> Force of the spring in a mode
   pure function spring_force(law, state, u) result(f)
      type(restraint_law), intent(in) :: law
      type(restraint_state), intent(in) :: state
      real(wp), intent(in) :: u
      real(wp) :: f
      select case (state%mode)
      case (yields_up)
         f = law%most
      case (yields_down)
         f = law%least
      case (slack)
         f = 0.0_wp
      case default
         f = law%trial(state, u)
      end select
   end function spring_force

   !> Forces of all restraints, springs and dashpots
   pure subroutine find_forces(set, i, q, v, state, f)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i                       !! 1 to +x, 2 to -x
      real(wp), intent(in) :: q                      !! [rad]
      real(wp), intent(in) :: v                      !! [rad/s]
      type(restraint_state), intent(in) :: state(:)
      real(wp), intent(out) :: f(:)
      integer :: k
      do k = 1, set%count
         f(k) = force(set, i, k, q, v, state(k))
      end do
   end subroutine find_forces

   !> Force of one restraint, spring and dashpot
   pure function force(set, i, k, q, v, state) result(f)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i                       !! 1 to +x, 2 to -x
      integer, intent(in) :: k                       !! which
      real(wp), intent(in) :: q                      !! [rad]
      real(wp), intent(in) :: v                      !! [rad/s]
      type(restraint_state), intent(in) :: state
      real(wp) :: f
      real(wp) :: u, du
      call set%path(i)%evaluate_path(k, q, u, du)
      f = spring_force(set%law(k), state, u) + dashpot(set%law(k), du * v)
   end function force

   !> Force of the dashpot at a rate
   pure function dashpot(law, rate) result(f)
      type(restraint_law), intent(in) :: law
      real(wp), intent(in) :: rate
      real(wp) :: f
      f = 0.0_wp
      if (law%viscous <= 0.0_wp) return
      f = law%viscous * rate
      if (abs(law%power - 1.0_wp) > 0.0_wp) f = sign(law%viscous * abs(rate)**law%power, rate)
   end function dashpot

   !> Moment of all restraints against growing q [N m]
   pure function moment(set, i, q, v, state) result(m)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i                       !! 1 to +x, 2 to -x
      real(wp), intent(in) :: q                      !! [rad]
      real(wp), intent(in) :: v                      !! [rad/s]
      type(restraint_state), intent(in) :: state(:)
      real(wp) :: m
      real(wp) :: u, du
      integer :: k
      m = 0.0_wp
      do k = 1, set%count
         call set%path(i)%evaluate_path(k, q, u, du)
         m = m + (spring_force(set%law(k), state(k), u) + dashpot(set%law(k), du * v)) * du
      end do
   end function moment

   !> Moment of the springs against growing q when pulled from rest for the first time [N m]
   pure function first_moment(set, i, q, state) result(m)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i
      real(wp), intent(in) :: q
      type(restraint_state), intent(in) :: state(:)  !! fresh
      real(wp) :: m
      real(wp) :: u, du
      integer :: k
      m = 0.0_wp
      do k = 1, set%count
         call set%path(i)%evaluate_path(k, q, u, du)
         m = m + min(set%law(k)%most, max(set%law(k)%least, set%law(k)%trial(state(k), u))) * du
      end do
   end function first_moment

   !> Energy stored in a spring beyond that of its prestress [J]
   pure function stored(law, state, u) result(e)
      class(restraint_law), intent(in) :: law
      type(restraint_state), intent(in) :: state
      real(wp), intent(in) :: u
      real(wp) :: e
      if (law%stiffness > 0.0_wp) then
         e = 0.5_wp * (spring_force(law, state, u)**2 - law%prestress**2) / law%stiffness
      else
         e = law%prestress * u
      end if
   end function stored

   !> Energy stored in all restraints beyond that of their prestress [J]
   pure function energy(set, i, q, state) result(e)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i
      real(wp), intent(in) :: q
      type(restraint_state), intent(in) :: state(:)
      real(wp) :: e
      real(wp) :: u, du
      integer :: k
      e = 0.0_wp
      do k = 1, set%count
         call set%path(i)%evaluate_path(k, q, u, du)
         e = e + set%law(k)%stored(state(k), u)
      end do
   end function energy

   !> Power that dashpots and yielding springs take up [W]
   pure function dissipation(set, i, q, v, state) result(p)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i
      real(wp), intent(in) :: q
      real(wp), intent(in) :: v
      type(restraint_state), intent(in) :: state(:)
      real(wp) :: p
      real(wp) :: u, du, rate
      integer :: k
      p = 0.0_wp
      do k = 1, set%count
         call set%path(i)%evaluate_path(k, q, u, du)
         rate = du * v
         p = p + dashpot(set%law(k), rate) * rate
         if (state(k)%mode == yields_up) p = p + set%law(k)%most * rate
         if (state(k)%mode == yields_down) p = p + set%law(k)%least * rate
      end do
   end function dissipation

   !> Is a restraint beyond its mode? By how much: a force, or a rate; above zero where it is
   pure function beyond(law, state, u, rate) result(g)
      type(restraint_law), intent(in) :: law
      type(restraint_state), intent(in) :: state
      real(wp), intent(in) :: u
      real(wp), intent(in) :: rate
      real(wp) :: g
      select case (state%mode)
      case (yields_up)
         g = -rate
      case (yields_down)
         g = rate
      case (slack)
         g = real(law%slack, wp) * law%trial(state, u) - law%slop
      case default
         g = law%trial(state, u)
         g = max(g - law%most, law%least - g) - law%slop
      end select
   end function beyond

   !> Fraction of a step at which the first restraint leaves its mode, and which; 0 and none where all stay.
   !>
   !> A fraction of zero with a restraint named: it leaves at once.
   subroutine find_leaving(set, i, step, until, state, fraction, which)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i                       !! 1 to +x, 2 to -x
      type(dense_step), intent(in) :: step
      real(wp), intent(in) :: until                  !! fraction of the step that is looked at
      type(restraint_state), intent(in) :: state(:)
      real(wp), intent(out) :: fraction
      integer, intent(out) :: which                  !! 0: none
      real(wp) :: low, high, middle
      integer :: n

      fraction = 0.0_wp
      which = 0
      do n = 1, looks
         high = until * real(n, wp) / real(looks, wp)
         if (last_beyond(high) > 0) exit
      end do
      if (n > looks) return
      low = until * real(n - 1, wp) / real(looks, wp)
      do n = 1, 60
         middle = 0.5_wp * (low + high)
         if (middle <= low .or. middle >= high) exit
         if (last_beyond(middle) > 0) then
            high = middle
         else
            low = middle
         end if
      end do
      which = last_beyond(high)
      fraction = high

   contains

      !> The last restraint that is beyond its mode at a fraction of the step, 0 where none is
      function last_beyond(s) result(last)
         real(wp), intent(in) :: s
         integer :: last
         real(wp) :: q, v, u, du
         v = step%rate(s)
         q = step%coordinate(s)
         do last = set%count, 1, -1
            call set%path(i)%evaluate_path(last, q, u, du)
            if (beyond(set%law(last), state(last), u, du * v) > 0.0_wp) return
         end do
      end function last_beyond

   end subroutine find_leaving

   !> One restraint goes over to its next mode at q
   pure subroutine change_mode(set, i, q, k, state)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i
      real(wp), intent(in) :: q
      integer, intent(in) :: k                        !! which
      type(restraint_state), intent(inout) :: state(:)
      real(wp) :: u, du
      call set%path(i)%evaluate_path(k, q, u, du)
      associate (law => set%law(k), one => state(k))
         select case (one%mode)
         case (yields_up, yields_down)
            call keep_set(law, one, u)
         case (slack)
            one%mode = elastic
         case default
            if (law%trial(one, u) - law%most > law%least - law%trial(one, u)) then
               one%mode = merge(slack, yields_up, law%slack < 0)
            else
               one%mode = merge(slack, yields_down, law%slack > 0)
            end if
         end select
      end associate
   end subroutine change_mode

   !> From yield back to elastic, the force unchanged
   pure subroutine keep_set(law, state, u)
      type(restraint_law), intent(in) :: law
      type(restraint_state), intent(inout) :: state
      real(wp), intent(in) :: u
      state%set = u - (spring_force(law, state, u) - law%prestress) / law%stiffness
      state%mode = elastic
   end subroutine keep_set

   !> Nothing yields while the structure stands still, or just after an impact: what goes on to yield does so at once
   pure subroutine settle_springs(set, i, q, state)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i
      real(wp), intent(in) :: q                         !! [rad]
      type(restraint_state), intent(inout) :: state(:)
      real(wp) :: u, du
      integer :: k
      do k = 1, set%count
         call set%path(i)%evaluate_path(k, q, u, du)
         if (state(k)%mode == yields_up .or. state(k)%mode == yields_down) call keep_set(set%law(k), state(k), u)
      end do
   end subroutine settle_springs

   !> Keep the least and greatest forces
   pure subroutine note_forces(set, i, q, v, state)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i
      real(wp), intent(in) :: q
      real(wp), intent(in) :: v
      type(restraint_state), intent(inout) :: state(:)
      real(wp) :: f
      integer :: k
      do k = 1, set%count
         f = force(set, i, k, q, v, state(k))
         state(k)%least = min(state(k)%least, f)
         state(k)%most = max(state(k)%most, f)
      end do
   end subroutine note_forces

   !> Least work against the springs on the way from q to q_there [J]; the way to the other side leads over rest.
   !>
   !> Dashpots, which only dissipate more, are not considered.
   pure function work_to(set, i, q, i_there, q_there, state) result(work)
      class(restraint_set), intent(in) :: set
      integer, intent(in) :: i
      real(wp), intent(in) :: q
      integer, intent(in) :: i_there
      real(wp), intent(in) :: q_there
      type(restraint_state), intent(in) :: state(:)
      real(wp) :: work
      real(wp) :: u, du, u_there
      type(restraint_state) :: one
      integer :: k
      work = 0.0_wp
      do k = 1, set%count
         call set%path(i)%evaluate_path(k, q, u, du)
         call set%path(i_there)%evaluate_path(k, q_there, u_there, du)
         one = state(k)
         if (i == i_there) then
            work = work + set%law(k)%resisted(one, u, u_there)
         else
            work = work + set%law(k)%resisted(one, u, 0.0_wp)
            call carry_spring(set%law(k), one, u, 0.0_wp)
            work = work + set%law(k)%resisted(one, 0.0_wp, u_there)
         end if
      end do
   end function work_to

   !> Work against a spring on the straight way from u to u_there [J]
   pure function resisted(law, state, u, u_there) result(work)
      class(restraint_law), intent(in) :: law
      type(restraint_state), intent(in) :: state
      real(wp), intent(in) :: u
      real(wp), intent(in) :: u_there
      real(wp) :: work
      real(wp) :: start
      if (law%stiffness > 0.0_wp) then
         start = spring_force(law, state, u)
         if (state%mode == slack) start = law%trial(state, u)
         work = (antiderivative(start + law%stiffness * (u_there - u)) - antiderivative(start)) / law%stiffness
      else
         work = law%prestress * (u_there - u)
      end if

   contains

      !> Of the force between its bounds, by the force without them
      pure function antiderivative(f) result(a)
         real(wp), intent(in) :: f
         real(wp) :: a
         real(wp) :: held
         held = min(law%most, max(law%least, f))
         a = 0.5_wp * held**2 + held * (f - held)
      end function antiderivative

   end function resisted

   !> Carry a spring from u to u_there
   pure subroutine carry_spring(law, state, u, u_there)
      type(restraint_law), intent(in) :: law
      type(restraint_state), intent(inout) :: state
      real(wp), intent(in) :: u
      real(wp), intent(in) :: u_there
      real(wp) :: f
      if (.not. law%stiffness > 0.0_wp) return
      if (state%mode == yields_up .or. state%mode == yields_down) call keep_set(law, state, u)
      state%mode = elastic
      f = law%trial(state, u_there)
      if (f > law%most .and. law%slack >= 0) state%set = u_there - (law%most - law%prestress) / law%stiffness
      if (f < law%least .and. law%slack <= 0) state%set = u_there - (law%least - law%prestress) / law%stiffness
      if (real(law%slack, wp) * law%trial(state, u_there) < 0.0_wp) state%mode = slack
   end subroutine carry_spring

end module rocking_restraint
