!> Ties, chains and hoops between blocks, in the plane and in space: one tension along a line through points that the
!> blocks carry. The line runs over its points without friction, so that a chain or hoop has the same tension
!> everywhere.
!>
!> With the length L of the line and L_0 at the start, the tension is that of an elastic, perfectly plastic tie,
!>
!>    T = T_0 + k (L - L_0 - e_p),   T_min <= T <= T_max.
!>
!> A bound of zero is slackness: the tie carries nothing and keeps its length. At any other bound it yields, and e_p is
!> the plastic elongation. A block feels T times the sum of the unit vectors to the neighbours of its point.
!>
!> A dashpot beside it resists the rate of the length, D = c |dL/dt|^n in the sense of the rate, of the position step
!> that led to the forces. Below a small rate it is linear, so that a step cannot reverse the rate.
!>
!> Energy: T^2 / 2k is stored, and the mean tension of a step times the change of e_p is lost, which closes the balance
!> with the trapezoidal work of dem_energy while T changes linearly in the step. The dashpot loses its mean force times
!> the change of length.
module dem_ties
   use common_kinds, only : wp
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: tie_set, tie_set_new, tie_set_copy, trace_ties, stretch_ties, add_tie_stiffness, tie_energy, tie_loss, &
      tie_dash_loss, tie_forces, forget_tie_losses

   type :: tie
      integer :: first = 0                     !! its points
      integer :: last = 0
      logical :: closed = .false.              !! the last point is joined to the first
      real(wp) :: stiffness = 0.0_wp           !! k [N/m]
      real(wp) :: length_start = 0.0_wp        !! L_0 [m]
      real(wp) :: prestress = 0.0_wp           !! T_0 [N]
      real(wp) :: least = 0.0_wp               !! T_min, at most 0 [N]
      real(wp) :: most = 0.0_wp                !! T_max, at least 0 [N]
      real(wp) :: length = 0.0_wp              !! L [m]
      real(wp) :: plastic = 0.0_wp             !! e_p [m]
      real(wp) :: tension = 0.0_wp             !! at the last forces [N]
      real(wp) :: lowest = 0.0_wp              !! least and greatest tension of any step since the settling [N]
      real(wp) :: highest = 0.0_wp
      real(wp) :: loss = 0.0_wp                !! by yielding [J]
      real(wp) :: damping = 0.0_wp             !! c [N (s/m)^n]
      real(wp) :: power = 1.0_wp               !! n
      real(wp) :: dash = 0.0_wp                !! D at the last forces [N]
      real(wp) :: before = 0.0_wp              !! L at the last forces [m]
      real(wp) :: dash_loss = 0.0_wp           !! in the dashpot [J]
   end type tie

   !> A place of a block, or of the ground, that has a share of the force at a point of the line
   type :: tie_anchor
      integer :: body = 0                      !! 0: the ground
      integer :: point = 0
      real(wp) :: share = 1.0_wp
      real(wp) :: place(3) = 0.0_wp            !! in the frame of the body, of the ground in space [m]
      real(wp) :: at(3) = 0.0_wp               !! in space [m]
      real(wp) :: force(3) = 0.0_wp            !! on the body [N]
      real(wp) :: before(3) = 0.0_wp           !! the same a step before [N]
      real(wp) :: answer = 0.0_wp              !! see add_tie_stiffness
      real(wp) :: mobility = 0.0_wp            !! acceleration by a force of one, in any direction at most [1/kg]
   end type tie_anchor

   type :: tie_set
      type(tie), allocatable :: item(:)
      type(tie_anchor), allocatable :: anchor(:)
      real(wp), allocatable :: at(:, :)        !! (3, points): means of their anchors [m]
      real(wp), allocatable :: pull(:, :)      !! (3, points) force of a tension of one: sums of unit vectors
      real(wp), allocatable :: near(:)         !! (points) sums of 1 / length of the segments that meet there [1/m]
      real(wp) :: support_work = 0.0_wp        !! done on the ties by the ground and by supports [J]
   end type tie_set

contains

   !> Ties from flat arrays
   subroutine tie_set_new(value, first, closed, body, point, place, bodies, ties, status)
      real(wp), intent(in) :: value(:, :)           !! (7, ties) k, L_0, T_0, T_min, T_max, c, n: N, m, s
      integer(c_int), intent(in) :: first(:)        !! (ties + 1) first point of each, 1-based
      integer(c_int), intent(in) :: closed(:)       !! (ties) 1: a hoop
      integer(c_int), intent(in) :: body(:)         !! (anchors) 1-based; 0: the ground
      integer(c_int), intent(in) :: point(:)        !! (anchors) 1-based
      real(wp), intent(in) :: place(:, :)           !! (3, anchors) in the frame of the body [m]
      integer, intent(in) :: bodies                 !! that there are
      type(tie_set), intent(out) :: ties
      integer(c_int), intent(out) :: status
      integer :: k, points, failed

      status = status_invalid_argument
      if (.not. all(value(1, :) >= 0.0_wp .and. value(2, :) > 0.0_wp .and. value(6, :) >= 0.0_wp)) return
      if (.not. all(value(1, :) + value(6, :) > 0.0_wp .and. value(7, :) > 0.0_wp)) return
      if (.not. all(value(4, :) <= 0.0_wp .and. value(5, :) >= 0.0_wp)) return
      if (.not. all(value(3, :) >= value(4, :) .and. value(3, :) <= value(5, :))) return
      points = int(first(size(first))) - 1
      if (first(1) /= 1 .or. any(first(2:) - first(:size(first) - 1) < 2)) return
      status = status_bad_index
      if (any(body < 0) .or. any(body > bodies) .or. any(point < 1) .or. any(point > points)) return
      do k = 1, points
         if (.not. any(point == k)) return
      end do
      status = status_out_of_memory
      allocate (ties%item(size(closed)), ties%anchor(size(body)), ties%at(3, points), ties%pull(3, points), &
         ties%near(points), stat=failed)
      if (failed /= 0) return
      do k = 1, size(closed)
         ties%item(k) = tie(first=int(first(k)), last=int(first(k + 1)) - 1, closed=closed(k) /= 0, &
            stiffness=value(1, k), length_start=value(2, k), prestress=value(3, k), least=value(4, k), &
            most=value(5, k), tension=value(3, k), damping=value(6, k), power=value(7, k))
      end do
      do k = 1, size(body)
         ties%anchor(k) = tie_anchor(body=int(body(k)), point=int(point(k)), &
            share=1.0_wp / real(count(point == point(k)), wp), place=place(:, k))
      end do
      status = status_ok
   end subroutine tie_set_new

   !> A copy of the ties; a set without ties if there are no ties
   subroutine tie_set_copy(from, to, status)
      type(tie_set), intent(in) :: from
      type(tie_set), intent(out) :: to
      integer(c_int), intent(out) :: status
      integer :: ties, anchors, points, failed
      ties = 0
      anchors = 0
      points = 0
      if (allocated(from%item)) then
         ties = size(from%item)
         anchors = size(from%anchor)
         points = size(from%at, 2)
      end if
      allocate (to%item(ties), to%anchor(anchors), to%at(3, points), to%pull(3, points), to%near(points), &
         stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0 .or. ties == 0) return
      to%item(:) = from%item
      to%anchor(:) = from%anchor
   end subroutine tie_set_copy

   !> Points, lengths and unit pulls of all ties, from the places of the anchors
   pure subroutine trace_ties(ties)
      type(tie_set), intent(inout) :: ties
      real(wp) :: part, along(3)
      integer :: k, n, next
      ties%at = 0.0_wp
      ties%pull = 0.0_wp
      ties%near = 0.0_wp
      do k = 1, size(ties%anchor)
         associate (one => ties%anchor(k))
            ties%at(:, one%point) = ties%at(:, one%point) + one%share * one%at
         end associate
      end do
      do n = 1, size(ties%item)
         associate (one => ties%item(n))
            one%length = 0.0_wp
            do k = one%first, merge(one%last, one%last - 1, one%closed)
               next = merge(one%first, k + 1, k == one%last)
               along = ties%at(:, next) - ties%at(:, k)
               part = norm2(along)
               one%length = one%length + part
               if (.not. part > 0.0_wp) cycle
               ties%pull(:, k) = ties%pull(:, k) + along / part
               ties%pull(:, next) = ties%pull(:, next) - along / part
               ties%near([k, next]) = ties%near([k, next]) + 1.0_wp / part
            end do
         end associate
      end do
   end subroutine trace_ties

   !> Tensions and forces on the anchors, from the places of the anchors
   pure subroutine stretch_ties(ties, span)
      type(tie_set), intent(inout) :: ties
      real(wp), intent(in) :: span                  !! position step that led here, 0 without dashpots [s]
      real(wp) :: mobility
      integer :: k, n
      call trace_ties(ties)
      do n = 1, size(ties%item)
         associate (one => ties%item(n))
            call load_tie(one)
            mobility = 0.0_wp
            if (one%damping > 0.0_wp) mobility = sum(ties%anchor%answer, &
               mask=ties%anchor%point >= one%first .and. ties%anchor%point <= one%last)**2
            call damp_tie(one, span, mobility)
            do k = one%first, one%last
               ties%pull(:, k) = (one%tension + one%dash) * ties%pull(:, k)
            end do
            one%lowest = min(one%lowest, one%tension + one%dash)
            one%highest = max(one%highest, one%tension + one%dash)
         end associate
      end do
      do k = 1, size(ties%anchor)
         associate (one => ties%anchor(k))
            one%before = one%force
            one%force = one%share * ties%pull(:, one%point)
         end associate
      end do
   end subroutine stretch_ties

   !> Tension of one tie at its length
   pure subroutine load_tie(one)
      type(tie), intent(inout) :: one
      real(wp) :: trial, new
      trial = one%prestress + one%stiffness * (one%length - one%length_start - one%plastic)
      new = min(max(trial, one%least), one%most)
      if (abs(new) > 0.0_wp .and. abs(trial - new) > 0.0_wp) then
         one%plastic = one%plastic + (trial - new) / one%stiffness
         one%loss = one%loss + 0.5_wp * (one%tension + new) * (trial - new) / one%stiffness
      end if
      one%tension = new
   end subroutine load_tie

   !> Force of the dashpot of one tie, whose length answers a tension of one with the acceleration `mobility`
   pure subroutine damp_tie(one, span, mobility)
      type(tie), intent(inout) :: one
      real(wp), intent(in) :: span                  !! [s]
      real(wp), intent(in) :: mobility              !! [1/kg]
      !> Of the rate of the length: what a force may change of it in a step
      real(wp), parameter :: most = 0.5_wp
      real(wp) :: rate, new
      new = 0.0_wp
      if (one%damping > 0.0_wp .and. span > 0.0_wp) then
         rate = (one%length - one%before) / span
         new = sign(one%damping * abs(rate)**one%power, rate)
         if (mobility * abs(new) * span > most * abs(rate)) new = most * rate / (mobility * span)
         one%dash_loss = one%dash_loss + 0.5_wp * (one%dash + new) * (one%length - one%before)
      end if
      one%dash = new
      one%before = one%length
   end subroutine damp_tie

   !> Add a bound of what the ties contribute to the greatest eigenvalue of each body's stiffness scaled by its masses.
   !> With g_i the pull at an anchor of body i, scaled so, the stiffness of a tie is k g g^T, and by Cauchy's inequality
   !> at most that of separate bodies with k |g_i| (sum of all |g_j|). A tension T across a segment of length l adds the
   !> geometric stiffness T / l, at most twice that at each of its ends; T is that of yielding where the tie yields.
   !> A dashpot counts as a frequency of twice its rate of decay, at a rate of the length of one.
   pure subroutine add_tie_stiffness(ties, square)
      type(tie_set), intent(inout) :: ties          !! answer: |g_i| of a pull of one, 0 of supports and of the ground
      real(wp), intent(inout) :: square(:)          !! (bodies) squares of frequencies [1/s^2]
      real(wp) :: total, tension
      integer :: k, n
      do k = 1, size(ties%item)
         associate (one => ties%item(k))
            tension = max(one%tension, one%prestress)
            if (one%most < 0.5_wp * huge(tension)) tension = one%most
            total = sum(ties%anchor%answer, mask=ties%anchor%point >= one%first .and. ties%anchor%point <= one%last)
            do n = 1, size(ties%anchor)
               associate (anchor => ties%anchor(n))
                  if (anchor%body == 0 .or. anchor%point < one%first .or. anchor%point > one%last) cycle
                  square(anchor%body) = square(anchor%body) + one%stiffness * anchor%answer * total &
                     + (2.0_wp * one%damping * anchor%answer * total)**2 &
                     + 2.0_wp * max(tension, 0.0_wp) * ties%near(anchor%point) * anchor%share * anchor%mobility
               end associate
            end do
         end associate
      end do
   end subroutine add_tie_stiffness

   !> Energy stored in all ties [J]
   pure function tie_energy(ties) result(energy)
      type(tie_set), intent(in) :: ties
      real(wp) :: energy
      energy = sum(0.5_wp * ties%item%tension**2 / ties%item%stiffness, mask=ties%item%stiffness > 0.0_wp)
   end function tie_energy

   !> Energy lost by yielding of all ties [J]
   pure function tie_loss(ties) result(energy)
      type(tie_set), intent(in) :: ties
      real(wp) :: energy
      energy = sum(ties%item%loss)
   end function tie_loss

   !> Energy lost in the dashpots [J]
   pure function tie_dash_loss(ties) result(energy)
      type(tie_set), intent(in) :: ties
      real(wp) :: energy
      energy = sum(ties%item%dash_loss)
   end function tie_dash_loss

   !> Forces of the ties at the last forces, dashpots included (ties) [N]
   pure function tie_forces(ties) result(force)
      type(tie_set), intent(in) :: ties
      real(wp) :: force(size(ties%item))
      force = ties%item%tension + ties%item%dash
   end function tie_forces

   !> Losses, work and extremes so far count no more
   pure subroutine forget_tie_losses(ties)
      type(tie_set), intent(inout) :: ties
      ties%item%loss = 0.0_wp
      ties%item%dash_loss = 0.0_wp
      ties%item%lowest = ties%item%tension
      ties%item%highest = ties%item%tension
      ties%support_work = 0.0_wp
   end subroutine forget_tie_losses

end module dem_ties
