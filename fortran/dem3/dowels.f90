!> Dowels across joints of blocks in space: they carry shear and no tension.
!>
!> A dowel stands in the first body at a place r1, with its axis n there, and reaches into the second at r2. With d the
!> way from the one place to the other and P = 1 - n n^T,
!>
!>    S = -k (P d - s),   |S| <= F
!>
!> on body 2, the opposite on body 1, both at the place in body 2. What goes beyond F is slip s, which stays: a ductile
!> dowel, as limit analysis takes it. Once the bodies part along n by more than the dowel reaches it is out for good.
!> On rigid contacts (dem3_moreau) P d = s holds at the end of every step, with |S| <= F, and no spring.
!> The force has a potential, and its dashpot is taken implicitly, as that of the shear springs is (dem3_law).
module dem3_dowels
   use common_kinds, only : wp
   use dem3_bodies, only : body, cross
   use dem3_law, only : answers, bounded, push_body, length_of
   implicit none
   private
   public :: dowel, act_dowel, dowel_energy, place_dowel

   type :: dowel
      integer :: body(2) = 0
      real(wp) :: place(3, 2) = 0.0_wp         !! r1, r2 in the frames of the bodies [m]
      real(wp) :: axis(3) = 0.0_wp             !! n, from the first to the second, in the frame of the first
      real(wp) :: stiffness = 0.0_wp           !! k [N/m]
      real(wp) :: strength = 0.0_wp            !! F [N]
      real(wp) :: reach = 0.0_wp               !! [m]
      real(wp) :: damping = 0.0_wp             !! stiffness-proportional, beta [s]
      logical :: is_out = .false.
      real(wp) :: slip(3) = 0.0_wp             !! s in the frame of the first [m]
      real(wp) :: most_slip = 0.0_wp           !! farthest that s has been [m]
      real(wp) :: spring(3) = 0.0_wp           !! on the second body [N]
      real(wp) :: dash(3) = 0.0_wp
      real(wp) :: friction_loss = 0.0_wp       !! by slip, and what the spring held when it went out [J]
      real(wp) :: damping_loss = 0.0_wp        !! [J]
      real(wp) :: support_work = 0.0_wp        !! [J]
   end type dowel

contains

   !> Force of a dowel at the present place of its bodies, added to both; predicted velocities follow
   pure subroutine act_dowel(kick, drift, a, b, one)
      real(wp), intent(in) :: kick              !! length of the velocity step [s]
      real(wp), intent(in) :: drift             !! length of the position step before [s]
      type(body), intent(inout) :: a            !! the first
      type(body), intent(inout) :: b            !! the second
      type(dowel), intent(inout) :: one
      real(wp) :: at(3), away(3), normal(3), offset(3), arm_a(3), arm_b(3), u(3), before(3), force(3), old_dash(3)

      if (one%is_out) return
      before = one%spring + one%dash
      old_dash = one%dash
      call place_dowel(one, a, b, at, away, normal)
      arm_a = at - a%x
      arm_b = at - b%x
      u = b%v - a%v + cross(b%spin, arm_b) - cross(a%spin, arm_a)
      if (dot_product(away, normal) > one%reach) then
         one%friction_loss = one%friction_loss + dowel_energy(one)
         one%is_out = .true.
         one%spring = 0.0_wp
         one%dash = 0.0_wp
      else
         offset = away - matmul(a%turn, one%slip)
         offset = offset - dot_product(offset, normal) * normal
         call load_dowel(kick, offset, normal, arm_a, arm_b, a, b, one)
      end if
      force = one%spring + one%dash
      one%damping_loss = one%damping_loss - 0.5_wp * drift * dot_product(old_dash + one%dash, u)
      if (a%fixed) one%support_work = one%support_work &
         + 0.5_wp * drift * dot_product(force + before, a%v + cross(a%spin, arm_a))
      if (b%fixed) one%support_work = one%support_work &
         - 0.5_wp * drift * dot_product(force + before, b%v + cross(b%spin, arm_b))
      call push_body(a, -force, -kick * (force - before), arm_a)
      call push_body(b, force, kick * (force - before), arm_b)
   end subroutine act_dowel

   !> Where a dowel is: its place in the second body, the way to there from its place in the first, and its axis
   pure subroutine place_dowel(one, a, b, at, away, axis)
      type(dowel), intent(in) :: one
      type(body), intent(in) :: a               !! the first
      type(body), intent(in) :: b               !! the second
      real(wp), intent(out) :: at(3)            !! [m]
      real(wp), intent(out) :: away(3)          !! [m]
      real(wp), intent(out) :: axis(3)
      at = b%x + matmul(b%turn, one%place(:, 2))
      away = at - a%x - matmul(a%turn, one%place(:, 1))
      axis = matmul(a%turn, one%axis)
   end subroutine place_dowel

   !> Spring and dashpot of a dowel that is in
   pure subroutine load_dowel(kick, offset, normal, arm_a, arm_b, a, b, one)
      real(wp), intent(in) :: kick              !! [s]
      real(wp), intent(in) :: offset(3)         !! P d - s [m]
      real(wp), intent(in) :: normal(3)
      real(wp), intent(in) :: arm_a(3)          !! from the centroids [m]
      real(wp), intent(in) :: arm_b(3)
      type(body), intent(in) :: a
      type(body), intent(in) :: b
      type(dowel), intent(inout) :: one
      real(wp) :: trial(3), new(3), answer(3, 3), star(3), along(3), length, w, viscous

      trial = -one%stiffness * offset
      if (length_of(trial) >= one%strength) then
         new = bounded(trial, one%strength)
         ! Mean force over the step times the slip.
         one%friction_loss = one%friction_loss + 0.5_wp * dot_product(trial - new, one%spring + new) / one%stiffness
         one%slip = one%slip + matmul((new - trial) / one%stiffness, a%turn)
         one%most_slip = max(one%most_slip, length_of(one%slip))
         one%spring = new
         one%dash = 0.0_wp
         return
      end if
      answer = answers(arm_a, arm_b, a, b)
      star = b%p - a%p + cross(b%pspin, arm_b) - cross(a%pspin, arm_a) + kick * matmul(answer, trial - one%spring)
      star = star - dot_product(star, normal) * normal
      length = length_of(star)
      new = 0.0_wp
      if (length > 0.0_wp) then
         along = star / length
         w = dot_product(along, matmul(answer, along))
         viscous = one%damping * one%stiffness
         ! The predicted velocity held the old dashpot force: u* is without it.
         new = -viscous * (star - kick * w * one%dash) / (1.0_wp + viscous * kick * w)
      end if
      one%spring = trial
      one%dash = bounded(trial + new, one%strength) - trial
   end subroutine load_dowel

   !> Energy in the spring of a dowel [J]
   pure function dowel_energy(one) result(energy)
      type(dowel), intent(in) :: one
      real(wp) :: energy
      energy = 0.5_wp * dot_product(one%spring, one%spring) / one%stiffness
   end function dowel_energy

end module dem3_dowels
