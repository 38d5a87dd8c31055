!> Two blocks, one upon the other, that rock without sliding or flight: two coordinates and their modes.
!>
!> q1 and q2 are the rotations of the lower and of the upper block, clockwise (to +x). Each of the two contacts is shut,
!> or open about its right (+1) or left (-1) edge: both open in the same sense or against each other, the upper block
!> alone, or both as one body are the four modes of Psycharis 1990. Here no transition is a rule of its own: which
!> contacts open at rest, while others rock, or after an impact follows from one condition, that at each edge of a
!> shut contact either a force (an impulse) presses or the edge parts. The solution is unique because the kinetic
!> energy is positive; after an impact it is Moreau's, without rebound, so that energy never grows.
!>
!> Why not nonsmooth_impulses, which solves that condition for free bodies: here an open contact keeps its pivot, which
!> leaves two unknowns and at most nine pairs of pivots, tried one by one for accelerations and for impulses alike.
module rocking_stack
   use common_kinds, only : wp, gravity, pi
   use common_status, only : status_ok, status_invalid_argument
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: stack, stack_new, stack_impact, stack_parameters
   public :: motion_about, solved, pressing, choose_pivots, energies, contact_forces, power

   !> Numbers of a stack: mass [kg], inertia [kg m^2], height of the centre above its foot [m] of the lower and of the
   !> upper block; half width of the lower foot, height of the lower block, half width of the contact between [m]
   integer, parameter :: stack_parameters = 9

   type :: stack
      real(wp) :: mass(2) = 0.0_wp
      real(wp) :: inertia(2) = 0.0_wp
      real(wp) :: centre(2) = 0.0_wp  !! height above the foot of each
      real(wp) :: half(2) = 0.0_wp    !! half width of the contacts: on the ground, between the blocks
      real(wp) :: height = 0.0_wp     !! of the lower block
      real(wp) :: limit(2) = 0.0_wp   !! |q1| and |q2 - q1| taken as collapse [rad]
      real(wp) :: rest_rate(2) = 0.0_wp  !! of q1 and q2 - q1 after an impact, below which a contact stays shut [rad/s]
   end type stack

   !> Equation of motion in a pair of pivots: matrix (accelerations of q1, q2) = right
   type :: pivot_equation
      real(wp) :: matrix(2, 2) = 0.0_wp
      real(wp) :: right(2) = 0.0_wp
   end type pivot_equation

contains

   !> Set up from the flat parameter list
   subroutine stack_new(parameters, blocks, status)
      real(wp), intent(in) :: parameters(:)  !! see stack_parameters
      type(stack), intent(out) :: blocks
      integer(c_int), intent(out) :: status
      real(wp) :: radius
      integer :: i

      status = status_invalid_argument
      if (size(parameters) /= stack_parameters) return
      if (any(parameters <= 0.0_wp) .or. parameters(8) <= parameters(3)) return
      blocks%mass = parameters([1, 4])
      blocks%inertia = parameters([2, 5])
      blocks%centre = parameters([3, 6])
      blocks%half = parameters([7, 9])
      blocks%height = parameters(8)
      do i = 1, 2
         blocks%limit(i) = min(2.0_wp * atan2(blocks%half(i), blocks%centre(i)), 0.5_wp * pi)
         ! a millionth of the energy that overturns the block alone
         radius = hypot(blocks%half(i), blocks%centre(i))
         blocks%rest_rate(i) = 1.0e-3_wp * sqrt(2.0_wp * blocks%mass(i) * gravity * (radius - blocks%centre(i)) &
            / (blocks%inertia(i) + blocks%mass(i) * radius**2))
      end do
      status = status_ok
   end subroutine stack_new

   !> From the pivot of the ground to the centre of the lower block and to the pivot between, and from there to the
   !> centre of the upper block, at rest
   pure subroutine find_arms(body, s, d1, e, d2)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)  !! pivots; 0 the middle
      real(wp), intent(out) :: d1(2)  !! to the centre of the lower block [m]
      real(wp), intent(out) :: e(2)   !! to the pivot between [m]
      real(wp), intent(out) :: d2(2)  !! from there to the centre of the upper block [m]
      d1 = [-s(1) * body%half(1), body%centre(1)]
      e = [s(2) * body%half(2) - s(1) * body%half(1), body%height]
      d2 = [-s(2) * body%half(2), body%centre(2)]
   end subroutine find_arms

   !> A vector turned clockwise
   pure function turned(v, q) result(w)
      real(wp), intent(in) :: v(2)
      real(wp), intent(in) :: q  !! [rad]
      real(wp) :: w(2)
      w = [v(1) * cos(q) + v(2) * sin(q), -v(1) * sin(q) + v(2) * cos(q)]
   end function turned

   !> Kinetic matrix about a pair of pivots, and K' of its coupling
   pure subroutine kinetic_matrix(body, s, q, matrix, slope)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)            !! pivots
      real(wp), intent(in) :: q(2)           !! rotations [rad]
      real(wp), intent(out) :: matrix(2, 2)  !! [kg m^2]
      real(wp), intent(out) :: slope         !! of the coupling by q2 - q1 [kg m^2]
      real(wp) :: d1(2), e(2), d2(2), along, across, r
      call find_arms(body, s, d1, e, d2)
      r = q(2) - q(1)
      along = dot_product(e, d2)
      across = e(1) * d2(2) - e(2) * d2(1)
      matrix(1, 1) = body%inertia(1) + body%mass(1) * dot_product(d1, d1) + body%mass(2) * dot_product(e, e)
      matrix(2, 2) = body%inertia(2) + body%mass(2) * dot_product(d2, d2)
      matrix(1, 2) = body%mass(2) * (along * cos(r) + across * sin(r))
      matrix(2, 1) = matrix(1, 2)
      slope = body%mass(2) * (across * cos(r) - along * sin(r))
   end subroutine kinetic_matrix

   !> The equation of motion about a pair of pivots
   pure function motion_about(body, s, q, v, ground) result(one)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)        !! pivots
      real(wp), intent(in) :: q(2)       !! rotations [rad]
      real(wp), intent(in) :: v(2)       !! rates [rad/s]
      real(wp), intent(in) :: ground(2)  !! acceleration to +x and up [m/s^2]
      type(pivot_equation) :: one
      real(wp) :: d1(2), e(2), d2(2), slope, first(2), second(2)
      call find_arms(body, s, d1, e, d2)
      call kinetic_matrix(body, s, q, one%matrix, slope)
      first = body%mass(1) * turned(d1, q(1)) + body%mass(2) * turned(e, q(1))
      second = body%mass(2) * turned(d2, q(2))
      one%right(1) = (gravity + ground(2)) * first(1) - ground(1) * first(2) - slope * v(2)**2
      one%right(2) = (gravity + ground(2)) * second(1) - ground(1) * second(2) + slope * v(1)**2
   end function motion_about

   !> The balance of momentum about a pair of pivots, of blocks that moved about others before
   pure function momentum_about(body, s, q, before, v) result(one)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)       !! after
      real(wp), intent(in) :: q(2)
      integer, intent(in) :: before(2)  !! pivots before
      real(wp), intent(in) :: v(2)      !! rates before
      type(pivot_equation) :: one
      real(wp) :: d1(2), e(2), d2(2), b1(2), be(2), b2(2), x1(2), x2(2), slope
      call find_arms(body, before, b1, be, b2)
      call find_arms(body, s, d1, e, d2)
      call kinetic_matrix(body, s, q, one%matrix, slope)
      x1 = v(1) * across(turned(b1, q(1)))
      x2 = v(1) * across(turned(be, q(1))) + v(2) * across(turned(b2, q(2)))
      one%right(1) = body%inertia(1) * v(1) + body%mass(1) * dot_product(x1, across(turned(d1, q(1)))) &
         + body%mass(2) * dot_product(x2, across(turned(e, q(1))))
      one%right(2) = body%inertia(2) * v(2) + body%mass(2) * dot_product(x2, across(turned(d2, q(2))))

   contains

      !> Change of a vector that turns clockwise
      pure function across(w) result(u)
         real(wp), intent(in) :: w(2)
         real(wp) :: u(2)
         u = [w(2), -w(1)]
      end function across

   end function momentum_about

   !> Rates (or accelerations) of q1 and q2 about a pair of pivots, contacts of pivot 0 shut
   pure function solved(one, s) result(x)
      type(pivot_equation), intent(in) :: one
      integer, intent(in) :: s(2)
      real(wp) :: x(2)
      real(wp) :: determinant
      if (s(1) == 0 .and. s(2) == 0) then
         x = 0.0_wp
      else if (s(1) == 0) then
         x = [0.0_wp, one%right(2) / one%matrix(2, 2)]
      else if (s(2) == 0) then
         x = sum(one%right) / sum(one%matrix)
      else
         determinant = one%matrix(1, 1) * one%matrix(2, 2) - one%matrix(1, 2)**2
         x = [one%matrix(2, 2) * one%right(1) - one%matrix(1, 2) * one%right(2), &
            one%matrix(1, 1) * one%right(2) - one%matrix(1, 2) * one%right(1)] / determinant
      end if
   end function solved

   !> Least pressing force of the edges of each shut contact, as its moment about the other edge [N m]; a large number
   !> where one is not shut. Of impulses, with momenta before instead of the motion [N m s].
   pure function pressing(body, s, q, v, x, ground, before) result(least)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)
      real(wp), intent(in) :: q(2), v(2)  !! of momenta: rates before
      real(wp), intent(in) :: x(2)        !! accelerations, or rates after
      real(wp), intent(in) :: ground(2)
      integer, intent(in), optional :: before(2)  !! pivots before an impact
      real(wp) :: least(2)                !! of the ground, of the contact between
      type(pivot_equation) :: one
      integer :: i, side, trial(2)
      real(wp) :: excess(2)
      least = huge(1.0_wp)
      do i = 1, 2
         if (s(i) /= 0) cycle
         do side = -1, 1, 2
            trial = s
            trial(i) = side
            if (present(before)) then
               one = momentum_about(body, trial, q, before, v)
            else
               one = motion_about(body, trial, q, v, ground)
            end if
            excess = matmul(one%matrix, x) - one%right
            ! the upper block turns with the lower where the contact between is shut
            if (i == 1 .and. s(2) == 0) excess(1) = sum(excess)
            ! the moment about this edge is that of the force of the other
            least(i) = min(least(i), real(side, wp) * excess(i))
         end do
      end do
   end function pressing

   !> The pivots about which contacts that touch go on, by accelerations, or by rates after an impact
   pure subroutine choose_pivots(body, touching, s, q, v, ground, x, before)
      type(stack), intent(in) :: body
      logical, intent(in) :: touching(2)  !! else the pivot is given
      integer, intent(inout) :: s(2)      !! pivots
      real(wp), intent(in) :: q(2), v(2)
      real(wp), intent(in) :: ground(2)
      real(wp), intent(out) :: x(2)       !! accelerations, or rates after
      integer, intent(in), optional :: before(2)  !! pivots before an impact
      real(wp) :: y(2), wrong, best, least(2), apart(2), scale(2)
      integer :: one, two, trial(2), found(2)
      integer, parameter :: order(3) = [0, 1, -1]

      best = huge(1.0_wp)
      found = s
      x = 0.0_wp
      ! moments over those of the weights, rotations over the angular unit g/height
      scale = gravity * [sum(body%mass) * body%half(1), body%mass(2) * body%half(2)]
      do one = 1, merge(3, 1, touching(1))
         do two = 1, merge(3, 1, touching(2))
            trial = s
            if (touching(1)) trial(1) = order(one)
            if (touching(2)) trial(2) = order(two)
            if (present(before)) then
               y = solved(momentum_about(body, trial, q, before, v), trial)
               least = pressing(body, trial, q, v, y, ground, before)
            else
               y = solved(motion_about(body, trial, q, v, ground), trial)
               least = pressing(body, trial, q, v, y, ground)
            end if
            apart = real(trial, wp) * [y(1), y(2) - y(1)]
            wrong = max(0.0_wp, maxval(-least / scale))
            if (touching(1) .and. trial(1) /= 0) wrong = max(wrong, -apart(1) * body%height / gravity)
            if (touching(2) .and. trial(2) /= 0) wrong = max(wrong, -apart(2) * body%height / gravity)
            if (wrong < best - 1.0e-12_wp) then
               best = wrong
               found = trial
               x = y
            end if
         end do
      end do
      s = found
   end subroutine choose_pivots

   !> Rates after an impact at contacts, and which stay open. A contact that hardly parts stays shut, and its impulses
   !> are found anew: to keep the other rate as it was would change the momentum, and might give energy.
   pure subroutine stack_impact(body, s, q, v, at, s_after, v_after)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)         !! pivots before
      real(wp), intent(in) :: q(2), v(2)
      logical, intent(in) :: at(2)        !! contacts that close
      integer, intent(out) :: s_after(2)
      real(wp), intent(out) :: v_after(2)
      logical :: touching(2), stays(2)
      touching = at .or. s == 0
      s_after = s
      call choose_pivots(body, touching, s_after, q, v, [0.0_wp, 0.0_wp], v_after, s)
      do
         stays = touching .and. s_after /= 0 &
            .and. real(s_after, wp) * [v_after(1), v_after(2) - v_after(1)] <= body%rest_rate
         if (.not. any(stays)) exit
         where (stays) s_after = 0
         v_after = solved(momentum_about(body, s_after, q, s, v), s_after)
      end do
   end subroutine stack_impact

   !> Kinetic and potential energy [J]
   pure function energies(body, s, q, v) result(energy)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)
      real(wp), intent(in) :: q(2), v(2)
      real(wp) :: energy(2)
      real(wp) :: matrix(2, 2), slope, d1(2), e(2), d2(2), rise(2), w(2)
      call kinetic_matrix(body, s, q, matrix, slope)
      call find_arms(body, s, d1, e, d2)
      w = turned(d1, q(1))
      rise(1) = w(2) - d1(2)
      w = turned(e, q(1)) + turned(d2, q(2))
      rise(2) = w(2) - e(2) - d2(2)
      energy = [0.5_wp * dot_product(v, matmul(matrix, v)), gravity * dot_product(body%mass, rise)]
   end function energies

   !> Forces of the ground on the lower and of the lower on the upper block, x and y [N]
   pure function contact_forces(body, s, q, v, a, ground) result(force)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)
      real(wp), intent(in) :: q(2), v(2), a(2)
      real(wp), intent(in) :: ground(2)
      real(wp) :: force(4)
      real(wp) :: d1(2), e(2), d2(2), x1(2), x2(2)
      call find_arms(body, s, d1, e, d2)
      x1 = bent(d1, 1)
      x2 = bent(e, 1) + bent(d2, 2)
      force(3:4) = body%mass(2) * (x2 + ground + [0.0_wp, gravity])
      force(1:2) = force(3:4) + body%mass(1) * (x1 + ground + [0.0_wp, gravity])

   contains

      !> Acceleration of the end of an arm that turns with block k
      pure function bent(arm, k) result(u)
         real(wp), intent(in) :: arm(2)
         integer, intent(in) :: k
         real(wp) :: u(2)
         real(wp) :: w(2)
         w = turned(arm, q(k))
         u = a(k) * [w(2), -w(1)] - v(k)**2 * w
      end function bent

   end function contact_forces

   !> Power of the ground [W]
   pure function power(body, s, q, v, ground) result(p)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)
      real(wp), intent(in) :: q(2), v(2)
      real(wp), intent(in) :: ground(2)
      real(wp) :: p
      real(wp) :: d1(2), e(2), d2(2), w(2), u(2)
      call find_arms(body, s, d1, e, d2)
      w = turned(body%mass(1) * d1 + body%mass(2) * e, q(1))
      u = turned(body%mass(2) * d2, q(2))
      p = -ground(1) * (v(1) * w(2) + v(2) * u(2)) + ground(2) * (v(1) * w(1) + v(2) * u(1))
   end function power

end module rocking_stack
